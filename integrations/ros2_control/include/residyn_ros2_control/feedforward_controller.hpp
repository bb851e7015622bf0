// A chainable controller: references of position, velocity and acceleration in, effort of a residyn model out.
#ifndef RESIDYN_ROS2_CONTROL__FEEDFORWARD_CONTROLLER_HPP_
#define RESIDYN_ROS2_CONTROL__FEEDFORWARD_CONTROLLER_HPP_

#include <memory>
#include <string>
#include <vector>

#include <controller_interface/chainable_controller_interface.hpp>
#include <residyn.hpp>
#include <residyn_ros2_control/feedforward_controller_parameters.hpp>

namespace residyn_ros2_control {

class FeedforwardController : public controller_interface::ChainableControllerInterface {
public:
    controller_interface::CallbackReturn on_init() override;
    controller_interface::CallbackReturn on_configure(const rclcpp_lifecycle::State& previous) override;
    controller_interface::CallbackReturn on_activate(const rclcpp_lifecycle::State& previous) override;
    controller_interface::CallbackReturn on_deactivate(const rclcpp_lifecycle::State& previous) override;
    controller_interface::InterfaceConfiguration command_interface_configuration() const override;
    controller_interface::InterfaceConfiguration state_interface_configuration() const override;

protected:
    std::vector<hardware_interface::CommandInterface> on_export_reference_interfaces() override;
    std::vector<hardware_interface::StateInterface> on_export_state_interfaces() override;
    controller_interface::return_type update_reference_from_subscribers(const rclcpp::Time& time,
                                                                        const rclcpp::Duration& period) override;
    controller_interface::return_type update_and_write_commands(const rclcpp::Time& time, const rclcpp::Duration& period) override;

private:
    std::shared_ptr<ParamListener> listener_;
    Params params_;
    std::unique_ptr<residyn::JointFeedforward> feedforward_;
    std::vector<double> effort_;
    double status_ = 0.0;  // flags of the last tick: a number that introspection shows
};

}  // namespace residyn_ros2_control

#endif
