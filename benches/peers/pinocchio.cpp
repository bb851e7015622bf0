// The peer of `cargo bench --bench dynamics`: Pinocchio's C++ on the robot that comes in on standard input.
//
// In: N, gravity (3), then per joint its placement (rotation row-major, origin) and its ten standard
// parameters, all about z. Then commands "NAME ITERATIONS"; the answer is the nanoseconds taken.

#include <pinocchio/spatial.hpp>
#include <pinocchio/multibody.hpp>
#include <pinocchio/algorithm/aba.hpp>
#include <pinocchio/algorithm/crba.hpp>
#include <pinocchio/algorithm/regressor.hpp>
#include <pinocchio/algorithm/rnea.hpp>

#include <chrono>
#include <iostream>
#include <string>

namespace pin = pinocchio;

int main()
{
  int n;
  std::cin >> n;
  pin::Model model;
  Eigen::Vector3d gravity;
  std::cin >> gravity.x() >> gravity.y() >> gravity.z();
  model.gravity.linear(gravity);
  for (int i = 0; i < n; ++i) {
    Eigen::Matrix3d rotation;
    Eigen::Vector3d origin;
    Eigen::Matrix<double, 10, 1> parameters;
    for (int r = 0; r < 3; ++r)
      for (int c = 0; c < 3; ++c) std::cin >> rotation(r, c);
    for (int k = 0; k < 3; ++k) std::cin >> origin[k];
    for (int k = 0; k < 10; ++k) std::cin >> parameters[k];
    const auto joint = model.addJoint(i, pin::JointModelRZ(), pin::SE3(rotation, origin), "j" + std::to_string(i));
    model.appendBodyToJoint(joint, pin::Inertia::FromDynamicParameters(parameters));
  }
  pin::Data data(model);
  const Eigen::VectorXd q = Eigen::VectorXd::LinSpaced(n, 0.1, 1.3);
  const Eigen::VectorXd qd = Eigen::VectorXd::LinSpaced(n, -1.0, 1.0);
  const Eigen::VectorXd qdd = Eigen::VectorXd::LinSpaced(n, 2.0, -3.0);
  Eigen::VectorXd moving = q;

  std::string name;
  long iterations;
  double sum = 0.0;
  std::cerr.precision(17);
  while (std::cin >> name >> iterations) {
    const auto start = std::chrono::steady_clock::now();
    for (long k = 0; k < iterations; ++k) {
      // The state changes, so that nothing can be hoisted out of the loop.
      moving[0] = q[0] + 1e-9 * double(k);
      if (name == "inverse_dynamics") sum += pin::rnea(model, data, moving, qd, qdd)[0];
      else if (name == "mass_matrix") sum += pin::crba(model, data, moving)(0, n - 1);
      else if (name == "forward_dynamics") sum += pin::aba(model, data, moving, qd, qdd)[0];
      else if (name == "regressor") sum += pin::computeJointTorqueRegressor(model, data, moving, qd, qdd)(0, 9);
      else return 1;
    }
    const auto end = std::chrono::steady_clock::now();
    std::cout << std::chrono::duration_cast<std::chrono::nanoseconds>(end - start).count() << std::endl;
  }
  return sum == 0.5 ? 2 : 0;
}
