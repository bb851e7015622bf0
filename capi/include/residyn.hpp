// C++17 over residyn.h: a handle that frees itself, arrays of any container, exceptions where a model is loaded and none in the loop.
#ifndef RESIDYN_HPP
#define RESIDYN_HPP

#include "residyn.h"

#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace residyn {

/// What went wrong outside the loop.
class Error : public std::runtime_error {
public:
    Error(residyn_code code, const std::string& words) : std::runtime_error(words), code_(code) {}
    residyn_code code() const noexcept { return code_; }

private:
    residyn_code code_;
};

/// Throws unless a call went well.
inline void check(residyn_code code) {
    if (code != RESIDYN_OK) {
        throw Error(code, residyn_last_error());
    }
}

/// Flags of one tick: `status.has(RESIDYN_LATE)`.
struct Status {
    std::uint32_t bits = 0;
    bool has(std::uint32_t flags) const noexcept { return (bits & flags) == flags; }
};

/// A loaded model with its memory, for one thread; clone() makes one for another.
///
/// Calls of the loop are noexcept and return a code. They take pointers and a length, or anything with data() and size():
/// std::array, std::vector, std::span, Eigen::VectorXd.
class Model {
public:
    /// Loads a model directory for a loop of `period` seconds (0: the period of training).
    explicit Model(const std::string& directory, double period = 0.0) {
        residyn_model* loaded = nullptr;
        check(residyn_load(directory.c_str(), period, &loaded));
        handle_.reset(loaded);
        prepare();
    }

    /// Loads the contents of model.json and of compensator.safetensors (empty: the physics alone).
    template <class Json, class Network>
    static Model from_memory(const Json& json, const Network& network, double period = 0.0) {
        residyn_model* loaded = nullptr;
        const auto* net = network.size() == 0 ? nullptr : reinterpret_cast<const std::uint8_t*>(network.data());
        check(residyn_load_memory(reinterpret_cast<const std::uint8_t*>(json.data()), json.size(), net, network.size(), period,
                                  &loaded));
        return Model(loaded);
    }

    /// Another model in the same state, for another thread.
    Model clone() const {
        residyn_model* copy = nullptr;
        check(residyn_clone(handle_.get(), &copy));
        return Model(copy);
    }

    std::size_t joints() const noexcept { return joints_; }
    double period() const noexcept { return period_; }
    bool is_compensated() const noexcept { return compensated_; }

    std::vector<std::string> joint_names() const {
        std::vector<std::string> names(joints_);
        for (std::size_t joint = 0; joint < joints_; ++joint) {
            const char* name = nullptr;
            check(residyn_joint_name(handle_.get(), joint, &name));
            names[joint] = name;
        }
        return names;
    }

    /// The handle, for calls that this class lacks.
    residyn_model* get() const noexcept { return handle_.get(); }

    // Before the loop.

    /// Largest torque and its fastest change, by joint; infinity for none.
    template <class Torque, class Rate>
    void set_limits(const Torque& torque, const Rate& rate) {
        if (torque.size() != rate.size()) {
            throw Error(RESIDYN_LENGTH, "as many limits of the rate as of the torque are needed");
        }
        check(residyn_set_limits(get(), torque.data(), rate.data(), torque.size()));
    }

    /// Time of the ramps, and the longest time that an old torque may stand, s.
    void set_times(double ramp, double hold) { check(residyn_set_times(get(), ramp, hold)); }

    /// By how much the drive is late, s, and whether it adds gravity's torque itself, which is then left out.
    void set_drive(double delay, bool adds_gravity) { check(residyn_set_drive(get(), delay, adds_gravity ? 1 : 0)); }

    // In the loop.

    residyn_code reset(double clock = std::numeric_limits<double>::quiet_NaN()) noexcept { return residyn_reset(get(), clock); }
    residyn_code pause(double seconds) noexcept { return residyn_pause(get(), seconds); }
    residyn_code start() noexcept { return residyn_start(get()); }
    residyn_code stop() noexcept { return residyn_stop(get()); }
    residyn_code pace(residyn_pace& pace) const noexcept { return residyn_pace_of(get(), &pace); }

    residyn_code torque(const double* q, const double* qd, const double* qdd, double* tau, std::size_t n,
                        Status* status = nullptr) noexcept {
        return residyn_torque(get(), q, qd, qdd, tau, n, status == nullptr ? nullptr : &status->bits);
    }

    template <class Q, class Qd, class Qdd, class Tau>
    residyn_code torque(const Q& q, const Qd& qd, const Qdd& qdd, Tau&& tau, Status* status = nullptr) noexcept {
        const std::size_t n = same(q, qd, qdd, tau);
        return torque(q.data(), qd.data(), qdd.data(), tau.data(), n, status);
    }

    residyn_code tick(double time, const double* q, const double* qd, const double* qdd, double* tau, std::size_t n,
                      Status& status) noexcept {
        return residyn_tick(get(), time, q, qd, qdd, tau, n, &status.bits);
    }

    template <class Q, class Qd, class Qdd, class Tau>
    residyn_code tick(double time, const Q& q, const Qd& qd, const Qdd& qdd, Tau&& tau, Status& status) noexcept {
        const std::size_t n = same(q, qd, qdd, tau);
        return tick(time, q.data(), qd.data(), qdd.data(), tau.data(), n, status);
    }

    template <class Tau>
    residyn_code friction(Tau&& tau) const noexcept {
        return residyn_friction(get(), tau.data(), tau.size());
    }

    template <class Tau>
    residyn_code compensator(Tau&& tau) const noexcept {
        return residyn_compensator(get(), tau.data(), tau.size());
    }

    template <class Excess>
    residyn_code range(Excess&& excess) const noexcept {
        return residyn_range(get(), excess.data(), excess.size());
    }

    template <class Q, class Qd, class Qdd, class Tau>
    residyn_code inverse_dynamics(const Q& q, const Qd& qd, const Qdd& qdd, Tau&& tau) noexcept {
        return residyn_inverse_dynamics(get(), q.data(), qd.data(), qdd.data(), tau.data(), same(q, qd, qdd, tau));
    }

    template <class Q, class Qd, class Tau, class Qdd>
    residyn_code forward_dynamics(const Q& q, const Qd& qd, const Tau& tau, Qdd&& qdd) noexcept {
        return residyn_forward_dynamics(get(), q.data(), qd.data(), tau.data(), qdd.data(), same(q, qd, tau, qdd));
    }

    template <class Q, class Tau>
    residyn_code gravity(const Q& q, Tau&& tau) noexcept {
        return residyn_gravity(get(), q.data(), tau.data(), same(q, tau));
    }

    /// `matrix` has joints × joints values, row by row.
    template <class Q, class Matrix>
    residyn_code mass_matrix(const Q& q, Matrix&& matrix) noexcept {
        const std::size_t n = static_cast<std::size_t>(q.size());
        const bool fits = static_cast<std::size_t>(matrix.size()) == n * n;
        return residyn_mass_matrix(get(), q.data(), matrix.data(), fits ? n : 0);
    }

private:
    struct Free {
        void operator()(residyn_model* model) const noexcept { residyn_free(model); }
    };

    explicit Model(residyn_model* loaded) : handle_(loaded) { prepare(); }

    void prepare() {
        int compensated = 0;
        check(residyn_joints(handle_.get(), &joints_));
        check(residyn_period(handle_.get(), &period_));
        check(residyn_is_compensated(handle_.get(), &compensated));
        compensated_ = compensated != 0;
    }

    /// The common length; 0, which every call refuses, where there is none.
    template <class First, class... Rest>
    static std::size_t same(const First& first, const Rest&... rest) noexcept {
        const std::size_t n = static_cast<std::size_t>(first.size());
        return ((static_cast<std::size_t>(rest.size()) == n) && ...) ? n : 0;
    }

    std::unique_ptr<residyn_model, Free> handle_;
    std::size_t joints_ = 0;
    double period_ = 0.0;
    bool compensated_ = false;
};

/// The torque of a loop whose joints may stand in another order than the model's: what a controller of any framework needs.
///
class JointFeedforward {
public:
    /// `joints`: the caller's, in the caller's order; each of the model's once. `period` of the loop, s (0: that of training).
    JointFeedforward(const std::string& directory, const std::vector<std::string>& joints, double period = 0.0)
        : model_(directory, period) {
        const std::vector<std::string> names = model_.joint_names();
        std::string known;
        for (const std::string& name : names) {
            known += known.empty() ? name : ", " + name;
        }
        if (joints.size() != names.size()) {
            throw Error(RESIDYN_LENGTH, "the model has the joints " + known);
        }
        for (const std::string& joint : joints) {
            std::size_t place = 0;
            while (place < names.size() && names[place] != joint) {
                ++place;
            }
            for (std::size_t earlier : place_) {
                place = earlier == place ? names.size() : place;
            }
            if (place == names.size()) {
                throw Error(RESIDYN_LENGTH, "joint " + joint + " is none of the model's, or given twice; they are " + known);
            }
            place_.push_back(place);
        }
        const std::size_t n = names.size();
        for (auto* part : {&q_, &qd_, &qdd_, &tau_}) {
            part->assign(n, 0.0);
        }
    }

    std::size_t joints() const noexcept { return place_.size(); }
    double period() const noexcept { return model_.period(); }
    Model& model() noexcept { return model_; }

    /// The next tick ramps up from zero; what was remembered of an earlier run is forgotten.
    residyn_code start() noexcept {
        const residyn_code code = model_.reset();
        return code == RESIDYN_OK ? model_.start() : code;
    }

    /// One tick: torque in the caller's order for a motion in the caller's order. `tau` is written on RESIDYN_OK alone.
    residyn_code tick(double time, const double* q, const double* qd, const double* qdd, double* tau, Status& status) noexcept {
        for (std::size_t i = 0; i < place_.size(); ++i) {
            q_[place_[i]] = q[i];
            qd_[place_[i]] = qd[i];
            qdd_[place_[i]] = qdd[i];
        }
        const residyn_code code = model_.tick(time, q_, qd_, qdd_, tau_, status);
        for (std::size_t i = 0; i < place_.size() && code == RESIDYN_OK; ++i) {
            tau[i] = tau_[place_[i]];
        }
        return code;
    }

private:
    Model model_;
    std::vector<std::size_t> place_;
    std::vector<double> q_, qd_, qdd_, tau_;
};

}  // namespace residyn

#endif
