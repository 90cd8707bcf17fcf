#pragma once

namespace selkie
{
  /// Coefficients and vector updates of Newmark's method; it knows nothing of
  /// the equation solved. Equations (L.23)-(L.25) of doc/theory.md.
  struct Newmark
  {
    const double beta, gamma; ///< no units
    const double dt;          ///< time step, s
    const double alpha1;      ///< 1/(beta dt^2), 1/s^2
    const double alpha2;      ///< 1/(beta dt), 1/s
    const double alpha3;      ///< (1 - 2 beta)/(2 beta)
    const double alpha4;      ///< gamma/(beta dt), 1/s
    const double alpha5;      ///< 1 - gamma/beta
    const double alpha6;      ///< (1 - gamma/(2 beta)) dt, s

    /// @throw SceneError unless beta, gamma and dt are positive and finite.
    Newmark(const double beta, const double gamma, const double dt);


    /// No inertia: v_{n+1} = du/dt, a_{n+1} = 0. @throw SceneError as above.
    static Newmark
    quasi_static(const double dt);

    /// The beta that damps high frequencies most for a given
    /// @p gamma >= 1/2: (gamma + 1/2)^2 / 4.
    static double
    beta_for(const double gamma)
    {
      return 0.25 * (gamma + 0.5) * (gamma + 0.5);
    }

    /// a_{n+1} for the displacement increment @p du and the old @p v and @p a.
    /// @tparam T anything with sums and products with a double: a number, a
    ///   dealii::Tensor (vectors of unknowns: entry by entry)
    template <typename T>
    T
    acceleration(const T &du, const T &v, const T &a) const
    {
      return alpha1 * du - alpha2 * v - alpha3 * a;
    }

    /// v_{n+1} likewise.
    template <typename T>
    T
    velocity(const T &du, const T &v, const T &a) const
    {
      return alpha4 * du + alpha5 * v + alpha6 * a;
    }

    /// The first guess for du: dt v + dt^2/2 a, exact for constant a.
    template <typename T>
    T
    predictor(const T &v, const T &a) const
    {
      return dt * v + (0.5 * dt * dt) * a;
    }

  private:
    struct QuasiStatic
    {};
    Newmark(const QuasiStatic, const double dt);
  };
} // namespace selkie
