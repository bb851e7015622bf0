// The identified rigid body behind the interface of the package inverse_dynamics_solver. Its calls are const, so each works on a
// mutable handle: one thread at a time, as that package's own solvers.
#include <memory>
#include <string>

#include <inverse_dynamics_solver/inverse_dynamics_solver.hpp>
#include <pluginlib/class_list_macros.hpp>
#include <rclcpp/parameter.hpp>
#include <residyn.hpp>

namespace residyn_ros2_control {

using Eigen::MatrixXd;
using Eigen::VectorXd;

class InverseDynamics : public inverse_dynamics_solver::InverseDynamicsSolver {
public:
    void initialize(rclcpp::node_interfaces::NodeParametersInterface::ConstSharedPtr parameters, const std::string& space,
                    const std::string&) override {
        const std::string name = (space.empty() ? "" : space + ".") + "model_directory";
        model_ = std::make_unique<residyn::Model>(parameters->get_parameter(name).as_string());
    }

    MatrixXd getInertiaMatrix(const VectorXd& q) const override {
        MatrixXd matrix(q.size(), q.size());  // symmetric, so that the order of its values is one
        residyn::check(model_->mass_matrix(q, matrix));
        return matrix;
    }

    VectorXd getGravityVector(const VectorXd& q) const override {
        VectorXd torque(q.size());
        residyn::check(model_->gravity(q, torque));
        return torque;
    }

    VectorXd getCoriolisVector(const VectorXd& q, const VectorXd& qd) const override {
        VectorXd torque(q.size());
        const VectorXd none = VectorXd::Zero(q.size());
        residyn::check(model_->inverse_dynamics(q, qd, none, torque));
        return torque - getGravityVector(q);
    }

    /// Friction at this velocity alone: what has a memory starts anew.
    VectorXd getFrictionVector(const VectorXd& qd) const override {
        VectorXd torque(qd.size());
        const VectorXd none = VectorXd::Zero(qd.size());
        residyn::check(model_->reset());
        residyn::check(model_->torque(none, qd, none, torque));
        residyn::check(model_->friction(torque));
        return torque;
    }

private:
    std::unique_ptr<residyn::Model> model_;
};

}  // namespace residyn_ros2_control

PLUGINLIB_EXPORT_CLASS(residyn_ros2_control::InverseDynamics, inverse_dynamics_solver::InverseDynamicsSolver)
