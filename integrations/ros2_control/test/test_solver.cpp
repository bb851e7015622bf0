// The solver's parts make up the library's inverse dynamics: test_solver MODEL.
#include <algorithm>
#include <cstdio>
#include <memory>
#include <string>
#include <utility>

#include <inverse_dynamics_solver/inverse_dynamics_solver.hpp>
#include <residyn.hpp>

std::unique_ptr<inverse_dynamics_solver::InverseDynamicsSolver> plugin();

namespace {

class Parameters : public rclcpp::node_interfaces::NodeParametersInterface {
public:
    explicit Parameters(std::string model) : model_(std::move(model)) {}
    rclcpp::Parameter get_parameter(const std::string& name) const override {
        return rclcpp::Parameter(name == "arm.model_directory" ? model_ : "");
    }

private:
    std::string model_;
};

}  // namespace

int main(int count, char** given) {
    if (count != 2) {
        std::fprintf(stderr, "usage: test_solver MODEL\n");
        return 2;
    }
    residyn::Model model(given[1]);
    const auto solver = plugin();
    solver->initialize(std::make_shared<Parameters>(given[1]), "arm", "");
    const auto n = static_cast<Eigen::Index>(model.joints());
    double worst = 0.0, largest = 0.0;
    for (int k = 0; k < 20; ++k) {
        const Eigen::VectorXd ramp = Eigen::VectorXd::LinSpaced(n, 0.1 * k, 1.0 + 0.1 * k);
        const Eigen::VectorXd q = ramp.array().sin(), qd = 2.0 * ramp.array().cos(), qdd = -3.0 * ramp.array().sin();
        Eigen::VectorXd expected(n);
        residyn::check(model.inverse_dynamics(q, qd, qdd, expected));
        worst = std::max(worst, (solver->getTorques(q, qd, qdd) - expected).cwiseAbs().maxCoeff());
        largest = std::max(largest, expected.cwiseAbs().maxCoeff());
        // Friction takes energy.
        if (qd.dot(solver->getFrictionVector(qd)) < 0.0) {
            std::fprintf(stderr, "error: friction drives\n");
            return 1;
        }
    }
    std::printf("%d joints, largest difference %g of %g\n", static_cast<int>(n), worst, largest);
    return largest > 0.0 && worst <= 1e-10 * largest ? 0 : 1;
}
