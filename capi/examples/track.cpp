// How well an arm in MuJoCo follows a reference under PD control with several feedforwards:
//
//   track PLANT.mjb GIVEN.xml MODEL REFERENCE TORQUES > table
//
// PLANT is the robot, GIVEN its description, MODEL a model directory. REFERENCE is text: the joints' number, their positions at
// mid-range, the number of motions; of each motion the number of rows, then q, qd, qdd of every joint row by row, 1 ms apart. TORQUES
// gets the model's feedforward, row by row, so that another program's can be compared with it. Printed: feedforward, motion, and of each
// joint the root mean square and the largest tracking error, rad (m).
#include <mujoco/mujoco.h>
#include <residyn.hpp>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <functional>
#include <iostream>
#include <iterator>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

namespace {

constexpr double kPeriod = 0.001;       // of the control loop, s
constexpr double kSettle = 1.0;         // at the first row before errors count, s
constexpr double kFrequency = 5.0;      // of the controller, Hz
constexpr double kDamping = 1.0;        // its damping ratio
constexpr double kSoftSign = 0.05;      // speed at which the described Coulomb friction has 0.76 of its size, rad/s (m/s)
constexpr double kPi = 3.14159265358979323846;

using Vector = std::vector<double>;

struct Row {
    Vector q, qd, qdd;
};
using Motion = std::vector<Row>;

struct Reference {
    Vector middle;
    std::vector<Motion> motions;
};

Reference read(const char* path) {
    std::ifstream file(path);
    std::size_t n = 0, motions = 0, rows = 0;
    auto values = [&](std::size_t count) {
        Vector v(count);
        for (double& x : v) {
            file >> x;
        }
        return v;
    };
    file >> n;
    Reference reference{values(n), {}};
    file >> motions;
    for (std::size_t m = 0; m < motions; ++m) {
        file >> rows;
        Motion motion(rows);
        for (Row& row : motion) {
            row = {values(n), values(n), values(n)};
        }
        reference.motions.push_back(std::move(motion));
    }
    if (!file) {
        throw std::runtime_error(std::string(path) + ": not a reference");
    }
    return reference;
}

/// A MuJoCo model with its state, and where the robot's joints stand in it.
class Simulated {
public:
    Simulated(mjModel* model, const std::vector<std::string>& joints) : model_(model), data_(mj_makeData(model)) {
        for (const std::string& name : joints) {
            const int joint = mj_name2id(model, mjOBJ_JOINT, name.c_str());
            if (joint < 0) {
                throw std::runtime_error("no joint " + name);
            }
            position_.push_back(model->jnt_qposadr[joint]);
            speed_.push_back(model->jnt_dofadr[joint]);
        }
    }
    ~Simulated() {
        mj_deleteData(data_);
        mj_deleteModel(model_);
    }
    Simulated(const Simulated&) = delete;
    Simulated& operator=(const Simulated&) = delete;

    const mjModel& model() const { return *model_; }
    double q(std::size_t joint) const { return data_->qpos[position_[joint]]; }
    double qd(std::size_t joint) const { return data_->qvel[speed_[joint]]; }
    int dof(std::size_t joint) const { return speed_[joint]; }

    void rest_at(const Vector& q) {
        mj_resetData(model_, data_);
        for (std::size_t j = 0; j < q.size(); ++j) {
            data_->qpos[position_[j]] = q[j];
        }
        mj_forward(model_, data_);
    }

    /// One control period under torques.
    void step(const Vector& torque) {
        for (std::size_t j = 0; j < torque.size(); ++j) {
            data_->qfrc_applied[speed_[j]] = torque[j];
        }
        const int steps = std::max(1, static_cast<int>(std::lround(kPeriod / model_->opt.timestep)));
        for (int s = 0; s < steps; ++s) {
            mj_step(model_, data_);
        }
    }

    /// Torque of rigid bodies, rotors and viscous friction on a motion; dry friction is left out.
    Vector inverse_dynamics(const Vector& q, const Vector& qd, const Vector& qdd) {
        model_->opt.disableflags |= mjDSBL_CONSTRAINT;
        mj_resetData(model_, data_);
        for (std::size_t j = 0; j < q.size(); ++j) {
            data_->qpos[position_[j]] = q[j];
            data_->qvel[speed_[j]] = qd[j];
            data_->qacc[speed_[j]] = qdd[j];
        }
        mj_inverse(model_, data_);
        Vector torque(q.size());
        for (std::size_t j = 0; j < q.size(); ++j) {
            torque[j] = data_->qfrc_inverse[speed_[j]];
        }
        return torque;
    }

    Vector inertia(const Vector& q) {
        rest_at(q);
        const std::size_t nv = static_cast<std::size_t>(model_->nv);
        Vector full(nv * nv), diagonal(q.size());
        mj_fullM(model_, data_, full.data());
        for (std::size_t j = 0; j < q.size(); ++j) {
            diagonal[j] = full[static_cast<std::size_t>(speed_[j]) * (nv + 1)];
        }
        return diagonal;
    }

private:
    mjModel* model_;
    mjData* data_;
    std::vector<int> position_, speed_;
};

using Feedforward = std::function<Vector(const Row&)>;

/// Runs one motion under PD control with a feedforward of the reference; prints the errors.
void follow(Simulated& plant, const Vector& inertia, const Motion& motion, const Feedforward& feedforward) {
    const std::size_t n = inertia.size();
    const double omega = 2.0 * kPi * kFrequency;
    plant.rest_at(motion.front().q);
    Vector square(n), largest(n);
    std::size_t rows = 0;
    const auto settle = static_cast<std::size_t>(kSettle / kPeriod);
    const Row still{motion.front().q, Vector(n), Vector(n)};
    for (std::size_t k = 0; k < settle + motion.size(); ++k) {
        const Row& wanted = k < settle ? still : motion[k - settle];
        Vector torque = feedforward(wanted);
        for (std::size_t j = 0; j < n; ++j) {
            const double error = wanted.q[j] - plant.q(j);
            if (k >= settle) {
                square[j] += error * error;
                largest[j] = std::max(largest[j], std::abs(error));
            }
            torque[j] += inertia[j] * (omega * omega * error + 2.0 * kDamping * omega * (wanted.qd[j] - plant.qd(j)));
        }
        rows += k >= settle;
        plant.step(torque);
    }
    for (std::size_t j = 0; j < n; ++j) {
        std::printf(" %.9g %.9g", std::sqrt(square[j] / static_cast<double>(rows)), largest[j]);
    }
    std::printf("\n");
}

int run(char** given) {
    char words[1000] = "";
    // The physics is the same directory without its network.
    residyn::Model whole(given[3], kPeriod);
    std::ifstream file(std::string(given[3]) + "/model.json", std::ios::binary);
    const std::string json{std::istreambuf_iterator<char>(file), {}};
    residyn::Model physics = residyn::Model::from_memory(json, std::string{}, kPeriod);
    mjModel* plant_model = mj_loadModel(given[1], nullptr);
    mjModel* given_model = mj_loadXML(given[2], nullptr, words, sizeof(words));
    if (plant_model == nullptr || given_model == nullptr) {
        std::cerr << "error: " << given[plant_model == nullptr ? 1 : 2] << ": " << words << '\n';
        return 2;
    }
    Simulated plant(plant_model, whole.joint_names()), described(given_model, whole.joint_names());
    const Reference reference = read(given[4]);
    const std::size_t n = whole.joints();
    if (reference.middle.size() != n) {
        std::cerr << "error: the reference has another number of joints than the model\n";
        return 2;
    }
    const Vector inertia = described.inertia(reference.middle), none(n);
    std::ofstream torques(given[5]);
    torques.precision(17);
    auto by_model = [&](residyn::Model& model, const Row& row) {
        Vector torque(n);
        residyn::check(model.torque(row.q, row.qd, row.qdd, torque));
        return torque;
    };
    const std::vector<std::pair<const char*, Feedforward>> rows = {
        {"none", [&](const Row&) { return none; }},
        {"gravity", [&](const Row& row) { return described.inverse_dynamics(row.q, none, none); }},
        {"rigid", [&](const Row& row) { return described.inverse_dynamics(row.q, row.qd, row.qdd); }},
        {"given",
         [&](const Row& row) {
             Vector torque = described.inverse_dynamics(row.q, row.qd, row.qdd);
             for (std::size_t j = 0; j < n; ++j) {
                 torque[j] += described.model().dof_frictionloss[described.dof(j)] * std::tanh(row.qd[j] / kSoftSign);
             }
             return torque;
         }},
        {"physics", [&](const Row& row) { return by_model(physics, row); }},
        {"model",
         [&](const Row& row) {
             Vector torque = by_model(whole, row);
             for (double t : torque) {
                 torques << t << ' ';
             }
             torques << '\n';
             return torque;
         }},
    };
    for (const auto& [name, feedforward] : rows) {
        for (std::size_t m = 0; m < reference.motions.size(); ++m) {
            residyn::check(whole.reset());
            residyn::check(physics.reset());
            std::printf("%s %zu", name, m);
            follow(plant, inertia, reference.motions[m], feedforward);
        }
    }
    return torques ? 0 : 1;
}

}  // namespace

int main(int count, char** given) {
    if (count != 6) {
        std::cerr << "usage: track PLANT.mjb GIVEN.xml MODEL REFERENCE TORQUES\n";
        return 2;
    }
    try {
        return run(given);
    } catch (const std::exception& error) {
        std::cerr << "error: " << error.what() << '\n';
        return 2;
    }
}
