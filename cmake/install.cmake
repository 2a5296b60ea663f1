# What `cmake --install` puts where: the program, and the library with its headers for find_package(silt).
# In another project the library is silt::simulation, by find_package or by add_subdirectory alike.
set(CMAKE_SKIP_INSTALL_ALL_DEPENDENCY ON)  # not the tests
include(GNUInstallDirs)
include(CMakePackageConfigHelpers)

set(libraries cpu device parallel lbm rigid collision hdf5 toml qhull mesh coupler simulation)
foreach(name IN LISTS libraries)
  add_library(silt::${name} ALIAS silt_${name})
  set_target_properties(silt_${name} PROPERTIES EXPORT_NAME ${name})
  target_compile_features(silt_${name} PUBLIC cxx_std_20)
  target_include_directories(silt_${name} INTERFACE $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}>
                                                    $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}/silt>)
  install(TARGETS silt_${name} EXPORT silt ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR}/silt)
endforeach()
target_compile_definitions(silt_parallel INTERFACE OMPI_SKIP_MPICXX)
install(TARGETS silt RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR})
foreach(folder cpu device parallel lbm rigid adapters coupler silt)
  install(DIRECTORY ${PROJECT_SOURCE_DIR}/${folder} DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/silt
          FILES_MATCHING PATTERN "*.hpp")
endforeach()
install(FILES ${PROJECT_SOURCE_DIR}/scripts/completion.bash DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions
        RENAME silt)
install(DIRECTORY ${PROJECT_SOURCE_DIR}/cases DESTINATION ${CMAKE_INSTALL_DATADIR}/silt PATTERN out* EXCLUDE PATTERN sweep EXCLUDE)
install(DIRECTORY ${PROJECT_SOURCE_DIR}/scripts/silt_results DESTINATION lib/python3/dist-packages
        FILES_MATCHING PATTERN "*.py")

set(package ${CMAKE_INSTALL_LIBDIR}/cmake/silt)
configure_package_config_file(${PROJECT_SOURCE_DIR}/cmake/siltConfig.cmake.in ${PROJECT_BINARY_DIR}/siltConfig.cmake
                              INSTALL_DESTINATION ${package})
write_basic_package_version_file(${PROJECT_BINARY_DIR}/siltConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/siltConfig.cmake ${PROJECT_BINARY_DIR}/siltConfigVersion.cmake DESTINATION ${package})
install(EXPORT silt NAMESPACE silt:: FILE siltTargets.cmake DESTINATION ${package})

# cpack in the build folder makes a Debian package; what the program needs is read from its binary. Without dpkg-shlibdeps (package
# dpkg-dev) CPack would make one that depends on nothing.
find_program(DPKG_SHLIBDEPS dpkg-shlibdeps)
if(DPKG_SHLIBDEPS)
  set(CPACK_GENERATOR DEB)
else()
  message(STATUS "cpack makes an archive and no Debian package: dpkg-shlibdeps is missing (install dpkg-dev)")
  set(CPACK_GENERATOR TGZ)
endif()
set(CPACK_PACKAGE_NAME silt)
set(CPACK_PACKAGE_CONTACT "Silt")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "rigid bodies in a viscous fluid, both fully resolved")
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_RECOMMENDS "openmpi-bin, python3-h5py")
set(CPACK_DEBIAN_PACKAGE_SUGGESTS "libhdf5-openmpi-dev, libeigen3-dev, libfmt-dev, libqhull-dev, libxxhash-dev, libfcl-dev")
include(CPack)
