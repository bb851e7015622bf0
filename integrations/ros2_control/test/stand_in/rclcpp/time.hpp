#pragma once
namespace rclcpp {

class Time {
public:
    explicit Time(double seconds) : seconds_(seconds) {}
    double seconds() const { return seconds_; }

private:
    double seconds_;
};

class Duration {};

}  // namespace rclcpp
