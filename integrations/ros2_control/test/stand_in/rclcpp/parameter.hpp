#pragma once
#include <string>
#include <utility>
namespace rclcpp {

class Parameter {
public:
    explicit Parameter(std::string value) : value_(std::move(value)) {}
    std::string as_string() const { return value_; }

private:
    std::string value_;
};

}  // namespace rclcpp
