// How many bytes the fluid's data structures take: capacities of all arrays that live through a step.
#include "fluid_server/step/wcsph.h"

namespace ballast::fluid {

namespace {

template <class T>
std::size_t bytes_of(const std::vector<T>& array) {
  return array.capacity() * sizeof(T);
}
template <class T>
std::size_t bytes_of(const std::vector<std::vector<T>>& arrays) {
  std::size_t sum = arrays.capacity() * sizeof(arrays[0]);
  for (const auto& array : arrays) sum += bytes_of(array);
  return sum;
}
template <class... Arrays>
std::size_t sum_of(const Arrays&... arrays) {
  return (std::size_t{0} + ... + bytes_of(arrays));
}

std::size_t bytes_of(const Particles& particles) {
  std::size_t sum = 0;
  particles.for_each_field([&](auto field) { sum += bytes_of(particles.*field); });
  return sum;
}

}  // namespace

std::size_t Neighbourhood::memory() const {
  return sum_of(x, y, z, record, source, fluid_item, sample_item) +
         sum_of(lists.buffer, lists.start, lists.count, lists.good_until, lists.group, lists.used) +
         sum_of(start_, start_fluid_, fluid_count_, moving_count_, static_start_, histogram_, row_fluid_, row_all_,
                row_counts_, row_place_) +
         sum_of(row_filled_, row_touched_, occupied_, active_, cell_of_, moving_cell_, moving_item_, static_source_);
}

std::size_t Samples::memory() const {
  return sum_of(body, local, normal, volume, depth, patch, record, first, order, patch_body);
}

std::size_t Response::memory() const {
  return (films_ ? films_->memory() : 0) +
         sum_of(wet_, viscous_, drag_, at_, wrenches_, acceleration_, spin_, patches_, contacts_);
}

std::size_t WcsphFluid::memory() const {
  return (implicit_ ? implicit_->memory() : 0) + (shifting_ ? shifting_->memory() : 0) + bytes_of(particles_) +
         bytes_of(before_) + samples_->memory() + items_->memory() + response_->memory() + barrier_->memory() +
         sum_of(extras_.normal, extras_.viscous, extras_.evening, extras_.density, pressure_, acceleration_, sums_);
}

}  // namespace ballast::fluid
