// Torque along a motion, in C++: follow MODEL PERIOD MOTION, as follow.c has it. Checks on the way that parts make up the whole, and
// that what a guard sends starts at zero and keeps its limits.
#include <residyn.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <iostream>
#include <iterator>
#include <limits>
#include <string>
#if __has_include(<span>)
#include <span>
#endif

namespace {

struct Row {
    double what, value;
    std::vector<double> q, qd, qdd, expected;
};

std::vector<Row> read(const char* path, std::size_t n) {
    std::ifstream file(path);
    // Streams do not read `nan`.
    const std::vector<std::string> words{std::istream_iterator<std::string>(file), {}};
    std::vector<Row> rows;
    for (std::size_t at = 0; at + 2 + 4 * n <= words.size();) {
        auto next = [&] { return std::strtod(words[at++].c_str(), nullptr); };
        Row row{next(), next(), {}, {}, {}, {}};
        for (auto* part : {&row.q, &row.qd, &row.qdd, &row.expected}) {
            std::generate_n(std::back_inserter(*part), n, next);
        }
        rows.push_back(row);
    }
    return rows;
}

bool fails(residyn_code code) {
    if (code != RESIDYN_OK) {
        std::cerr << "error: " << residyn_last_error() << '\n';
    }
    return code != RESIDYN_OK;
}

/// Whether a guarded loop sends nothing at first, and no more than a quarter of the largest torque.
bool keeps_its_limits(residyn::Model model, const std::vector<Row>& rows, double largest) {
    const std::vector<double> limit(model.joints(), largest / 4), rate(model.joints(), std::numeric_limits<double>::infinity());
    model.set_limits(limit, rate);
    std::vector<double> tau(model.joints());
    residyn::Status status;
    bool limited = false, kept = !fails(model.reset());
    double time = 0.0;
    for (std::size_t k = 0; k < rows.size() && kept; ++k, time += model.period()) {
        if (k == 1) {
            kept = kept && status.has(RESIDYN_STOPPED) && !fails(model.start());
        }
        kept = kept && !fails(model.tick(time, rows[k].q, rows[k].qd, rows[k].qdd, tau, status));
        limited = limited || status.has(RESIDYN_TORQUE_LIMITED);
        for (double t : tau) {
            kept = kept && std::abs(t) <= largest / 4;
        }
    }
    residyn_pace pace{};
    return kept && limited && !fails(model.pace(pace)) && pace.missed == 0;
}

int follow(const char* directory, double period, const char* path) {
    residyn::Model model(directory, period);
    const std::size_t n = model.joints();
    const std::vector<Row> rows = read(path, n);
    const residyn::Model fresh = model.clone();
    std::vector<double> tau(n), friction(n), compensator(n), rigid(n), excess(n), matrix(n * n);
    double worst = 0.0, largest = 0.0;
    for (const Row& row : rows) {
        const residyn_code code = row.what == 1.0 ? model.reset(row.value) : row.what == 2.0 ? model.pause(row.value) : RESIDYN_OK;
        residyn::Status status;
        if (fails(code) || fails(model.torque(row.q, row.qd, row.qdd, tau, &status))) {
            return 2;
        }
        if (fails(model.friction(friction)) || fails(model.compensator(compensator)) || fails(model.range(excess)) ||
            fails(model.inverse_dynamics(row.q, row.qd, row.qdd, rigid)) || fails(model.mass_matrix(row.q, matrix))) {
            return 2;
        }
        for (std::size_t j = 0; j < n; ++j) {
            worst = std::max(worst, std::abs(tau[j] - row.expected[j]));
            largest = std::max(largest, std::abs(row.expected[j]));
            if (model.is_compensated() && excess[j] > 0.6 && !status.has(RESIDYN_UNCOMPENSATED)) {
                std::cerr << "error: far outside the training, and no flag says so\n";
                return 1;
            }
        }
    }
    // Another number of joints is a code, whatever the container.
    std::array<double, 1> one{};
    if (model.torque(one, one, one, one) != RESIDYN_LENGTH) {
        return 1;
    }
#if defined(__cpp_lib_span)
    if (!rows.empty() && fails(model.gravity(std::span<const double>(rows[0].q), std::span<double>(tau)))) {
        return 2;
    }
#endif
    const bool kept = keeps_its_limits(fresh.clone(), rows, largest);
    std::cout << rows.size() << " samples of " << n << " joints, largest difference " << worst / largest
              << " of the largest torque; limits " << (kept ? "kept" : "broken") << '\n';
    return !rows.empty() && worst <= 1e-6 * largest && kept ? 0 : 1;
}

}  // namespace

int main(int count, char** given) {
    if (count != 4) {
        std::cerr << "usage: follow MODEL PERIOD MOTION\n";
        return 2;
    }
    try {
        return follow(given[1], std::atof(given[2]), given[3]);
    } catch (const residyn::Error& error) {
        std::cerr << "error: " << error.what() << '\n';
        return 2;
    }
}
