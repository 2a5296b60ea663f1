#include "lbm/levels/levels.hpp"

namespace silt::lbm {

CollisionSpec coarser(CollisionSpec spec, int levels) {
  const double factor = 1 << levels;
  spec.relaxation_time = 0.5 + (spec.relaxation_time - 0.5) / factor;
  for (double& f : spec.force) f *= factor;
  // A border emits waves of the cell width. At low viscosity `magic` damps their odd half too little in a
  // flow that carries them to and fro; no wall of a body on these levels needs `magic`.
  if (spec.model == Collision::trt && levels > 0)
    spec.magic = spec.excess() * (spec.stable_odd_relaxation_time() - 0.5);
  return spec;
}

HeatSpec coarser(HeatSpec spec, int levels) {
  const double factor = 1 << levels;
  spec.diffusivity /= factor;
  for (double& f : spec.buoyancy) f *= factor;
  for (double& g : spec.gradient) g *= factor;
  return spec;
}

template <class T>
Levels<T>::Levels(Fluid<T>& finest, int coarser_levels, Temperature<T>* heat, const Levels* before)
    : finest_(finest), heat_(heat), seconds_(coarser_levels + 1) {
  const Domain& domain = finest.domain();
  borders_.reserve(coarser_levels), heat_borders_.reserve(coarser_levels);
  for (int level = 1; level <= coarser_levels; ++level) {
    coarser_.push_back(std::make_unique<Fluid<T>>(
        Domain(domain.tree(), domain.sides(), domain.ranks(), level), coarser(finest.spec(), level),
        finest.comm(), finest.device(), before ? &before->fluid(level) : nullptr));
    borders_.emplace_back(fluid(level - 1), fluid(level));
    if (!heat) continue;
    coarser_heat_.push_back(
        std::make_unique<Temperature<T>>(fluid(level), coarser(heat->spec(), level), heat->domain().sides()));
    heat_borders_.emplace_back(*this->heat(level - 1), *this->heat(level));
  }
}

template <class T>
void Levels<T>::set_passes(std::int64_t done) {
  for (int level = 0; level < count(); ++level) fluid(level).set_passes(done >> level);
}

template <class T>
void Levels<T>::begin_step() {
  for (int level = count() - 1; level > 0; --level) {
    if (finest_.passes() % (1 << level) != 0) continue;
    const double begin = MPI_Wtime();
    begin_pass(level);
    at_border(level - 1, [](auto& border) { border.before_coarse_pass(); });
    pass_over(level);
    fluid(level).exchange();
    at_border(level - 1, [](auto& border) { border.after_coarse_pass(); });
    end_pass(level);
    seconds_[level] += MPI_Wtime() - begin;
  }
  begin_pass(0);
}

template <class T>
void Levels<T>::begin_pass(int level) {
  if (!is_coarsest(level)) at_border(level, [](auto& border) { border.begin_fine_pass(); });
}

template <class T>
void Levels<T>::pass_over(int level) {
  Fluid<T>& its = fluid(level);
  if (is_coarsest(level) || !its.is_in_parts()) return its.stream_collide();
  its.begin_pass();
  for (int b = 0; b < int(its.blocks().size()); ++b)
    for (int part = 0; part < its.parts(b); ++part) {
      its.collide(b, part);
      at_border(level, [&](auto& border) { border.after_part(b, part); });
    }
  its.end_pass();
}

template <class T>
void Levels<T>::end_pass(int level) {
  if (!is_coarsest(level)) at_border(level, [](auto& border) { border.end_fine_pass(); });
}

template class Levels<float>;
template class Levels<double>;

}  // namespace silt::lbm
