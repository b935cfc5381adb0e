// Pinocchio's algorithms over rows in memory: what a C++ user's loop would do, timed from outside.
#include <pinocchio/multibody.hpp>
#include <pinocchio/algorithm/aba.hpp>
#include <pinocchio/algorithm/aba-derivatives.hpp>
#include <pinocchio/algorithm/cholesky.hpp>
#include <pinocchio/algorithm/crba.hpp>
#include <pinocchio/algorithm/regressor.hpp>
#include <pinocchio/algorithm/rnea.hpp>
#include <pinocchio/algorithm/rnea-derivatives.hpp>
#include <pinocchio/serialization.hpp>

#include <cstring>
#include <string>

using namespace pinocchio;
using Row = Eigen::Map<const Eigen::VectorXd>;

namespace {
Model model;
Data data;

// The row's states, copied to aligned vectors, and where its results go.
struct State {
  Eigen::VectorXd q, v, a;
  double* out;
  template <typename M>
  void give(const M& m) {  // in its own storage order
    std::memcpy(out, m.data(), sizeof(double) * m.size());
    out += m.size();
  }
};

template <typename F>
void each(const double* q, const double* v, const double* a, double* out, long rows, long size, F f) {
  const long n = model.nv;
  State s{Eigen::VectorXd(n), Eigen::VectorXd(n), Eigen::VectorXd(n), out};
  for (long i = 0; i < rows; ++i) {
    s.q = Row(q + i * n, n);
    s.v = Row(v + i * n, n);
    s.a = Row(a + i * n, n);
    s.out = out + i * size;
    f(s);
  }
}
}  // namespace

#define LOOP(NAME, SIZE, ...)                                                             \
  extern "C" void NAME(const double* q, const double* v, const double* a, double* out,    \
                       long rows) {                                                       \
    const long n = model.nv;                                                              \
    each(q, v, a, out, rows, SIZE, [n](State& s) { __VA_ARGS__; });                       \
  }

extern "C" void load(const char* file) {
  serialization::loadFromText(model, std::string(file));
  data = Data(model);
}

LOOP(inverse_dynamics, n, std::memcpy(s.out, rnea(model, data, s.q, s.v, s.a).data(), 8 * n))
LOOP(forward_dynamics, n, std::memcpy(s.out, aba(model, data, s.q, s.v, s.a).data(), 8 * n))
LOOP(gravity, n, std::memcpy(s.out, computeGeneralizedGravity(model, data, s.q).data(), 8 * n))
LOOP(mass_matrix, n * n, std::memcpy(s.out, crba(model, data, s.q).data(), 8 * n * n))
LOOP(mass_matrix_inverse, n * n,
     std::memcpy(s.out, computeMinverse(model, data, s.q).data(), 8 * n * n))
LOOP(coriolis_matrix, n * n,
     std::memcpy(s.out, computeCoriolisMatrix(model, data, s.q, s.v).data(), 8 * n * n))
LOOP(inverse_dynamics_derivatives, 3 * n * n, computeRNEADerivatives(model, data, s.q, s.v, s.a);
     s.give(data.dtau_dq); s.give(data.dtau_dv); s.give(data.M))
LOOP(forward_dynamics_derivatives, 3 * n * n, computeABADerivatives(model, data, s.q, s.v, s.a);
     s.give(data.ddq_dq); s.give(data.ddq_dv); s.give(data.Minv))
LOOP(regressor, 10 * n * n,
     std::memcpy(s.out, computeJointTorqueRegressor(model, data, s.q, s.v, s.a).data(),
                 80 * n * n))
