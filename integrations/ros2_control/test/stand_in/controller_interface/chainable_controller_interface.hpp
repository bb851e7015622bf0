#pragma once
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <hardware_interface/handle.hpp>
#include <rclcpp/time.hpp>
#include <rclcpp_lifecycle/state.hpp>

namespace controller_interface {

enum class CallbackReturn { SUCCESS, FAILURE, ERROR };
enum class return_type { OK, ERROR };
enum class interface_configuration_type { ALL, INDIVIDUAL, NONE };

struct InterfaceConfiguration {
    interface_configuration_type type;
    std::vector<std::string> names = {};
};

struct Logger {};

class Node {
public:
    explicit Node(std::string name) : name_(std::move(name)) {}
    const char* get_name() const { return name_.c_str(); }
    Logger get_logger() const { return {}; }

private:
    std::string name_;
};

class ChainableControllerInterface {
public:
    virtual ~ChainableControllerInterface() = default;
    virtual CallbackReturn on_init() = 0;
    virtual CallbackReturn on_configure(const rclcpp_lifecycle::State&) = 0;
    virtual CallbackReturn on_activate(const rclcpp_lifecycle::State&) = 0;
    virtual CallbackReturn on_deactivate(const rclcpp_lifecycle::State&) = 0;
    virtual InterfaceConfiguration command_interface_configuration() const = 0;
    virtual InterfaceConfiguration state_interface_configuration() const = 0;

    std::shared_ptr<Node> get_node() const { return node_; }
    unsigned int get_update_rate() const { return rate_; }

    // What the controller manager does.
    void init(const std::string& name, unsigned int rate) {
        node_ = std::make_shared<Node>(name);
        rate_ = rate;
    }
    std::vector<hardware_interface::CommandInterface> export_reference_interfaces() { return on_export_reference_interfaces(); }
    std::vector<hardware_interface::StateInterface> export_state_interfaces() { return on_export_state_interfaces(); }
    void assign(std::vector<hardware_interface::LoanedCommandInterface> commands) { command_interfaces_ = std::move(commands); }
    return_type update(const rclcpp::Time& time, const rclcpp::Duration& period) {
        const return_type code = update_reference_from_subscribers(time, period);
        return code == return_type::OK ? update_and_write_commands(time, period) : code;
    }

protected:
    virtual std::vector<hardware_interface::CommandInterface> on_export_reference_interfaces() = 0;
    virtual std::vector<hardware_interface::StateInterface> on_export_state_interfaces() = 0;
    virtual return_type update_reference_from_subscribers(const rclcpp::Time&, const rclcpp::Duration&) = 0;
    virtual return_type update_and_write_commands(const rclcpp::Time&, const rclcpp::Duration&) = 0;

    std::vector<double> reference_interfaces_;
    std::vector<hardware_interface::LoanedCommandInterface> command_interfaces_;

private:
    std::shared_ptr<Node> node_;
    unsigned int rate_ = 0;
};

}  // namespace controller_interface
