// The controller in the hands of a stand-in of the controller manager: test_controller MODEL. Its effort is the model's torque, its
// joints stand in another order than the model's, update() allocates nothing, and wrong parameters are refused.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <limits>
#include <memory>
#include <new>
#include <string>
#include <vector>

#include <controller_interface/chainable_controller_interface.hpp>
#include <residyn.hpp>
#include <residyn_ros2_control/feedforward_controller_parameters.hpp>

std::unique_ptr<controller_interface::ChainableControllerInterface> plugin();

namespace {

std::size_t allocations = 0;

using controller_interface::CallbackReturn;
using controller_interface::return_type;

constexpr unsigned int kRate = 1000;
const rclcpp_lifecycle::State kState;

int failed(const char* what) {
    std::fprintf(stderr, "error: %s\n", what);
    return 1;
}

/// A controller with its hardware: efforts by joint in the controller's order.
struct Loaded {
    std::unique_ptr<controller_interface::ChainableControllerInterface> controller = plugin();
    std::vector<double> effort;
    std::vector<hardware_interface::CommandInterface> commands, references;
    std::vector<hardware_interface::StateInterface> states;

    CallbackReturn configure() {
        controller->init("feedforward", kRate);
        const CallbackReturn begun = controller->on_init();
        return begun == CallbackReturn::SUCCESS ? controller->on_configure(kState) : begun;
    }

    void connect() {
        const auto names = controller->command_interface_configuration().names;
        effort.assign(names.size(), std::numeric_limits<double>::quiet_NaN());
        for (std::size_t j = 0; j < names.size(); ++j) {
            const std::string joint = names[j].substr(0, names[j].rfind('/'));
            commands.emplace_back(joint, "effort", &effort[j]);
        }
        std::vector<hardware_interface::LoanedCommandInterface> loans(commands.begin(), commands.end());
        controller->assign(std::move(loans));
        references = controller->export_reference_interfaces();
        states = controller->export_state_interfaces();
    }
};

}  // namespace

// Kept apart, so that the compiler does not see malloc behind new.
[[gnu::noinline]] void* operator new(std::size_t size) {
    ++allocations;
    if (void* place = std::malloc(size)) {
        return place;
    }
    throw std::bad_alloc();
}
[[gnu::noinline]] void operator delete(void* place) noexcept { std::free(place); }
[[gnu::noinline]] void operator delete(void* place, std::size_t) noexcept { std::free(place); }

int main(int count, char** given) {
    if (count != 2) {
        return failed("usage: test_controller MODEL");
    }
    residyn::Model model(given[1], 1.0 / kRate);
    const std::vector<std::string> names = model.joint_names();
    const std::size_t n = names.size();
    auto& parameters = residyn_ros2_control::parameters();

    parameters.model_directory = "/nowhere";
    parameters.joints = names;
    if (Loaded().configure() != CallbackReturn::FAILURE) {
        return failed("a directory that is not there is taken");
    }
    parameters.model_directory = given[1];
    parameters.joints.back() = "no such joint";
    if (Loaded().configure() != CallbackReturn::FAILURE) {
        return failed("a joint that the model lacks is taken");
    }
    parameters.joints.back() = names.front();
    if (n > 1 && Loaded().configure() != CallbackReturn::FAILURE) {
        return failed("a joint that is given twice is taken");
    }

    parameters.joints.assign(names.rbegin(), names.rend());
    parameters.ramp = 0.0;
    Loaded loaded;
    if (loaded.configure() != CallbackReturn::SUCCESS) {
        return failed("the controller cannot be configured");
    }
    loaded.connect();
    if (loaded.references.size() != 3 * n || loaded.references[0].get_name() != "feedforward/" + names.back() + "/position") {
        return failed("references have other names");
    }
    if (loaded.controller->on_activate(kState) != CallbackReturn::SUCCESS) {
        return failed("the controller cannot be activated");
    }

    std::vector<double> q(n), qd(n), qdd(n), tau(n);
    double worst = 0.0, largest = 0.0;
    for (unsigned int k = 0; k < 5 * kRate; ++k) {
        const double t = static_cast<double>(k) / kRate;
        for (std::size_t j = 0; j < n; ++j) {
            const double w = 1.0 + 0.3 * static_cast<double>(j);
            q[j] = 0.2 * std::sin(w * t);
            qd[j] = 0.2 * w * std::cos(w * t);
            qdd[j] = -0.2 * w * w * std::sin(w * t);
            const std::size_t i = n - 1 - j;
            loaded.references[i].set_value(q[j]);
            loaded.references[n + i].set_value(qd[j]);
            loaded.references[2 * n + i].set_value(qdd[j]);
        }
        if (k == 0) {
            // The model's own limits hold for both.
            model.set_times(parameters.ramp, parameters.hold);
            residyn::check(model.start());
        }
        const std::size_t before = allocations;
        const return_type code = loaded.controller->update(rclcpp::Time(t), rclcpp::Duration());
        if (allocations != before) {
            return failed("update() allocates");
        }
        residyn::Status status;
        if (code != return_type::OK || model.tick(t, q, qd, qdd, tau, status) != RESIDYN_OK) {
            return failed("a tick fails");
        }
        if (loaded.states[0].get_value() != status.bits) {
            return failed("the status is another one than the library's");
        }
        for (std::size_t j = 0; j < n; ++j) {
            worst = std::max(worst, std::abs(tau[j] - loaded.effort[n - 1 - j]));
            largest = std::max(largest, std::abs(tau[j]));
        }
    }
    // A reference that nobody writes is bad input: the last effort stands, and the status says so.
    loaded.references[0].set_value(std::numeric_limits<double>::quiet_NaN());
    const std::vector<double> last = loaded.effort;
    loaded.controller->update(rclcpp::Time(5.0), rclcpp::Duration());
    if (loaded.effort != last || (static_cast<unsigned>(loaded.states[0].get_value()) & RESIDYN_BAD_INPUT) == 0) {
        return failed("a missing reference is not held");
    }
    loaded.controller->on_deactivate(kState);
    if (std::any_of(loaded.effort.begin(), loaded.effort.end(), [](double e) { return e != 0.0; })) {
        return failed("an effort stands after the end");
    }
    std::printf("%zu joints, largest difference %g of %g\n", n, worst, largest);
    return worst == 0.0 && largest > 0.0 ? 0 : 1;
}
