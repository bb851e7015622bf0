#include <residyn_ros2_control/feedforward_controller.hpp>

#include <array>
#include <limits>

#include <hardware_interface/types/hardware_interface_type_values.hpp>
#include <pluginlib/class_list_macros.hpp>
#include <rclcpp/logging.hpp>

namespace residyn_ros2_control {

using controller_interface::CallbackReturn;
using controller_interface::InterfaceConfiguration;
using controller_interface::interface_configuration_type;
using controller_interface::return_type;

namespace {
constexpr std::array<const char*, 3> kReferences = {hardware_interface::HW_IF_POSITION, hardware_interface::HW_IF_VELOCITY,
                                                    hardware_interface::HW_IF_ACCELERATION};
constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
}  // namespace

CallbackReturn FeedforwardController::on_init() {
    try {
        listener_ = std::make_shared<ParamListener>(get_node());
        params_ = listener_->get_params();
    } catch (const std::exception& error) {
        RCLCPP_ERROR(get_node()->get_logger(), "%s", error.what());
        return CallbackReturn::ERROR;
    }
    return CallbackReturn::SUCCESS;
}

CallbackReturn FeedforwardController::on_configure(const rclcpp_lifecycle::State&) {
    try {
        params_ = listener_->get_params();
        const double period = get_update_rate() > 0 ? 1.0 / get_update_rate() : 0.0;
        feedforward_ = std::make_unique<residyn::JointFeedforward>(params_.model_directory, params_.joints, period);
        feedforward_->model().set_times(params_.ramp, params_.hold);
        feedforward_->model().set_drive(params_.drive_delay, params_.drive_adds_gravity);
    } catch (const std::exception& error) {
        RCLCPP_ERROR(get_node()->get_logger(), "%s", error.what());
        return CallbackReturn::FAILURE;
    }
    effort_.assign(feedforward_->joints(), 0.0);
    return CallbackReturn::SUCCESS;
}

CallbackReturn FeedforwardController::on_activate(const rclcpp_lifecycle::State&) {
    reference_interfaces_.assign(reference_interfaces_.size(), kNone);
    return feedforward_->start() == RESIDYN_OK ? CallbackReturn::SUCCESS : CallbackReturn::ERROR;
}

CallbackReturn FeedforwardController::on_deactivate(const rclcpp_lifecycle::State&) {
    for (auto& command : command_interfaces_) {
        static_cast<void>(command.set_value(0.0));
    }
    return CallbackReturn::SUCCESS;
}

InterfaceConfiguration FeedforwardController::command_interface_configuration() const {
    InterfaceConfiguration configuration{interface_configuration_type::INDIVIDUAL, {}};
    for (const std::string& joint : params_.joints) {
        configuration.names.push_back(joint + "/" + hardware_interface::HW_IF_EFFORT);
    }
    return configuration;
}

InterfaceConfiguration FeedforwardController::state_interface_configuration() const {
    return {interface_configuration_type::NONE, {}};
}

std::vector<hardware_interface::CommandInterface> FeedforwardController::on_export_reference_interfaces() {
    const std::size_t n = params_.joints.size();
    reference_interfaces_.assign(kReferences.size() * n, kNone);
    std::vector<hardware_interface::CommandInterface> exported;
    for (std::size_t kind = 0; kind < kReferences.size(); ++kind) {
        for (std::size_t joint = 0; joint < n; ++joint) {
            exported.emplace_back(std::string(get_node()->get_name()) + "/" + params_.joints[joint], kReferences[kind],
                                  &reference_interfaces_[kind * n + joint]);
        }
    }
    return exported;
}

std::vector<hardware_interface::StateInterface> FeedforwardController::on_export_state_interfaces() {
    std::vector<hardware_interface::StateInterface> exported;
    exported.emplace_back(get_node()->get_name(), "status", &status_);
    return exported;
}

return_type FeedforwardController::update_reference_from_subscribers(const rclcpp::Time&, const rclcpp::Duration&) {
    // References come from the controller before this one alone.
    return return_type::OK;
}

return_type FeedforwardController::update_and_write_commands(const rclcpp::Time& time, const rclcpp::Duration&) {
    const std::size_t n = feedforward_->joints();
    const double* reference = reference_interfaces_.data();
    residyn::Status status;
    if (feedforward_->tick(time.seconds(), reference, reference + n, reference + 2 * n, effort_.data(), status) != RESIDYN_OK) {
        return return_type::ERROR;
    }
    status_ = status.bits;
    bool written = true;
    for (std::size_t joint = 0; joint < n; ++joint) {
        written = command_interfaces_[joint].set_value(effort_[joint]) && written;
    }
    return written ? return_type::OK : return_type::ERROR;
}

}  // namespace residyn_ros2_control

PLUGINLIB_EXPORT_CLASS(residyn_ros2_control::FeedforwardController, controller_interface::ChainableControllerInterface)
