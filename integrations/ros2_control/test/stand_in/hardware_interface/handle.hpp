#pragma once
#include <string>
#include <utility>
namespace hardware_interface {

class Handle {
public:
    Handle(std::string prefix, std::string interface, double* value)
        : prefix_(std::move(prefix)), interface_(std::move(interface)), value_(value) {}
    std::string get_name() const { return prefix_ + "/" + interface_; }
    double get_value() const { return *value_; }

protected:
    std::string prefix_, interface_;
    double* value_;
};

class StateInterface : public Handle {
public:
    using Handle::Handle;
};

class CommandInterface : public Handle {
public:
    using Handle::Handle;
    void set_value(double value) { *value_ = value; }
};

class LoanedCommandInterface {
public:
    explicit LoanedCommandInterface(CommandInterface& command) : command_(&command) {}
    [[nodiscard]] bool set_value(double value) {
        command_->set_value(value);
        return true;
    }

private:
    CommandInterface* command_;
};

}  // namespace hardware_interface
