// What generate_parameter_library makes of src/feedforward_controller_parameters.yaml, its values from the test.
#pragma once
#include <memory>
#include <string>
#include <vector>

#include <controller_interface/chainable_controller_interface.hpp>

namespace residyn_ros2_control {

struct Params {
    std::string model_directory;
    std::vector<std::string> joints;
    bool drive_adds_gravity = false;
    double drive_delay = 0.0;
    double hold = 0.02;
    double ramp = 0.5;
};

/// What the test sets before on_init.
inline Params& parameters() {
    static Params params;
    return params;
}

class ParamListener {
public:
    explicit ParamListener(const std::shared_ptr<controller_interface::Node>&) {}
    Params get_params() const { return parameters(); }
};

}  // namespace residyn_ros2_control
