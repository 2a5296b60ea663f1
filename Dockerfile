# An image with the program silt, its cases and its Python reader:
#
#   docker build -t silt .
#   docker run --rm -v "$PWD:/work" silt run CASE
#   docker run --rm -v "$PWD:/work" --entrypoint mpirun silt -n 2 silt run CASE
#
# The folder the container starts in is /work; the cases are in /usr/share/silt/cases.
FROM debian:12 AS build
COPY scripts/setup /silt/scripts/
RUN /silt/scripts/setup && apt-get install -y --no-install-recommends git file dpkg-dev
COPY . /silt
RUN cmake -S /silt -B /build -G Ninja -D CMAKE_BUILD_TYPE=Release -D SILT_TESTS=OFF && ninja -C /build && cd /build && cpack

FROM debian:12
COPY --from=build /build/*.deb /tmp/
RUN apt-get update && apt-get install -y --no-install-recommends /tmp/*.deb openmpi-bin python3-h5py && rm -rf /var/lib/apt/lists/* /tmp/*.deb
# what is in a container is root to Open MPI
ENV OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1
WORKDIR /work
ENTRYPOINT ["silt"]
