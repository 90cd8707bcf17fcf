#pragma once

#include <deal.II/lac/la_parallel_vector.h>

namespace selkie
{
  /// Values on nodes or unknowns, with ghosts.
  using Vector = dealii::LinearAlgebra::distributed::Vector<double>;

  constexpr unsigned int invalid_index = static_cast<unsigned int>(-1);
} // namespace selkie
