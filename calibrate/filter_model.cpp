// SPDX-License-Identifier: Apache-2.0
#include "calibrate/filter_model.h"

#include <glm/gtc/constants.hpp>

#include <algorithm>
#include <array>
#include <cmath>

namespace nearfield::calibrate {
namespace {

// Conditions are met to 1e-7: well below any sigma, well above rounding of the matrix.
constexpr double kConditionWeight = 1e14;
constexpr double kSlopeStep = 1e-4;  // pitches; a quadratic's central difference is exact

double lower_edge(std::size_t cell, std::size_t cells) {
    return static_cast<double>(cell) - 0.5 * static_cast<double>(cells);
}

// 1, x, x^2 of the knot in the cell's own parameters.
void add_powers(double x, double sign, int index, Eigen::VectorXd& row) {
    row[index] += sign;
    row[index + 1] += sign * x;
    row[index + 2] += sign * x * x;
}

// One sample's derivatives: few of all parameters.
struct SampleRow {
    std::vector<int> index;
    std::vector<double> slope;
    double value = 0;

    void add(int at, double derivative) {
        index.push_back(at);
        slope.push_back(derivative);
    }
};

void fill_row(const FilterSample& sample,
              const FilterParameters& parameters,
              glm::dvec2 pitch_m,
              SampleRow& row) {
    row.index.clear();
    row.slope.clear();
    const OnFilter at = on_filter(sample, parameters, pitch_m);
    const auto phi = [&](double x, double spread) {
        return blurred_value(parameters.cells, x, spread);
    };
    const double px = phi(at.x.x, at.spread.x), py = phi(at.x.y, at.spread.y);
    const double dx =
        (phi(at.x.x + kSlopeStep, at.spread.x) - phi(at.x.x - kSlopeStep, at.spread.x)) /
        (2.0 * kSlopeStep);
    const double dy =
        (phi(at.x.y + kSlopeStep, at.spread.y) - phi(at.x.y - kSlopeStep, at.spread.y)) /
        (2.0 * kSlopeStep);
    const double peak = parameters.peak[static_cast<std::size_t>(sample.color)];
    row.value = peak * px * py;
    // x = R^T (u - c), c in pitches of the filter's own axes before they are turned.
    const double cosine = std::cos(parameters.turn_rad), sine = std::sin(parameters.turn_rad);
    const glm::dvec2 slope = peak * glm::dvec2(dx * py, px * dy);
    const double aspect = pitch_m.y / pitch_m.x;
    row.add(2 * sample.view, -slope.x * cosine + slope.y * sine / aspect);
    row.add(2 * sample.view + 1, -slope.x * sine * aspect - slope.y * cosine);
    row.add(parameters.turn_index(), slope.x * at.x.y * aspect - slope.y * at.x.x / aspect);
    row.add(parameters.peak_index(sample.color), px * py);
    const std::size_t cells = parameters.cells.size();
    for (std::size_t c = 0; c < cells; ++c) {
        const double lower = lower_edge(c, cells);
        const glm::dvec3 along_x = blurred_moments(at.x.x, at.spread.x, lower, lower + 1.0);
        const glm::dvec3 along_y = blurred_moments(at.x.y, at.spread.y, lower, lower + 1.0);
        const glm::dvec3 both = peak * (py * along_x + px * along_y);
        for (int power = 0; power < 3; ++power)
            row.add(parameters.cell_index(c) + power, both[power]);
    }
}

}  // namespace

int FilterParameters::count() const {
    return peak_index(0) + static_cast<int>(peak.size()) + 3 * static_cast<int>(cells.size());
}

int FilterParameters::cell_index(std::size_t cell) const {
    return peak_index(0) + static_cast<int>(peak.size()) + 3 * static_cast<int>(cell);
}

void FilterParameters::add(const Eigen::VectorXd& step) {
    for (std::size_t view = 0; view < center.size(); ++view) {
        const int at = 2 * static_cast<int>(view);
        center[view] += glm::dvec2(step[at], step[at + 1]);
    }
    turn_rad += step[turn_index()];
    for (std::size_t color = 0; color < peak.size(); ++color)
        peak[color] += step[peak_index(static_cast<int>(color))];
    for (std::size_t c = 0; c < cells.size(); ++c) {
        for (std::size_t power = 0; power < 3; ++power)
            cells[c][power] += step[cell_index(c) + static_cast<int>(power)];
    }
}

glm::dvec3 blurred_moments(double x, double s, double lower, double upper) {
    if (!(s > 0.0)) {
        const bool is_inside = x >= lower && x < upper;
        return is_inside ? glm::dvec3(1.0, x, x * x) : glm::dvec3(0.0);
    }
    const double a = (lower - x) / s, b = (upper - x) / s;
    const auto density = [](double z) {
        return std::exp(-0.5 * z * z) / std::sqrt(2.0 * glm::pi<double>());
    };
    const double at_a = density(a), at_b = density(b);
    const double inside =
        0.5 * (std::erfc(a / glm::root_two<double>()) - std::erfc(b / glm::root_two<double>()));
    return {inside, x * inside + s * (at_a - at_b),
            (x * x + s * s) * inside + s * (at_a * (lower + x) - at_b * (upper + x))};
}

OnFilter on_filter(const FilterSample& sample,
                   const FilterParameters& parameters,
                   glm::dvec2 pitch_m) {
    const double cosine = std::cos(parameters.turn_rad), sine = std::sin(parameters.turn_rad);
    const glm::dvec2 from_center =
        sample.u_m - parameters.center[static_cast<std::size_t>(sample.view)] * pitch_m;
    const glm::dvec2 x_m(cosine * from_center.x + sine * from_center.y,
                         cosine * from_center.y - sine * from_center.x);
    const glm::dvec2 spread_m(std::hypot(cosine * sample.spread_m.x, sine * sample.spread_m.y),
                              std::hypot(cosine * sample.spread_m.y, sine * sample.spread_m.x));
    return {x_m / pitch_m, spread_m / pitch_m};
}

double blurred_value(const std::vector<std::array<double, 3>>& cells, double x, double spread) {
    double sum = 0;
    for (std::size_t c = 0; c < cells.size(); ++c) {
        const double lower = lower_edge(c, cells.size());
        constexpr double kReach = 8.0;  // sigmas: nothing is left beyond
        if (x + kReach * spread < lower || x - kReach * spread > lower + 1.0)
            continue;
        const glm::dvec3 moments = blurred_moments(x, spread, lower, lower + 1.0);
        sum += cells[c][0] * moments.x + cells[c][1] * moments.y + cells[c][2] * moments.z;
    }
    return sum;
}

Condition peak_condition(const FilterParameters& parameters) {
    Condition condition{Eigen::VectorXd::Zero(parameters.count()), 1.0};
    const std::size_t cells = parameters.cells.size();
    if (cells % 2 == 1) {
        condition.row[parameters.cell_index(cells / 2)] = 1.0;
    } else {  // the mean of what the two middle cells say
        condition.row[parameters.cell_index(cells / 2)] = 0.5;
        condition.row[parameters.cell_index(cells / 2 - 1)] = 0.5;
    }
    return condition;
}

Condition center_condition(const FilterParameters& parameters) {
    Condition condition{Eigen::VectorXd::Zero(parameters.count()), 0.0};
    const std::size_t cells = parameters.cells.size();
    for (std::size_t c = 0; c < cells; ++c) {
        const double a = lower_edge(c, cells), b = a + 1.0;
        for (int power = 0; power < 3; ++power)
            condition.row[parameters.cell_index(c) + power] =
                (std::pow(b, power + 2) - std::pow(a, power + 2)) / (power + 2);
    }
    return condition;
}

Eigen::VectorXd jump_row(const FilterParameters& parameters, std::size_t knot) {
    Eigen::VectorXd row = Eigen::VectorXd::Zero(parameters.count());
    const std::size_t cells = parameters.cells.size();
    const double x = lower_edge(knot, cells);
    if (knot < cells)
        add_powers(x, 1.0, parameters.cell_index(knot), row);
    if (knot > 0)
        add_powers(x, -1.0, parameters.cell_index(knot - 1), row);
    return row;
}

NormalEquations normal_equations(const std::vector<FilterSample>& samples,
                                 const FilterParameters& parameters,
                                 glm::dvec2 pitch_m,
                                 const std::vector<Condition>& conditions) {
    const int count = parameters.count();
    NormalEquations normal;
    normal.matrix = Eigen::MatrixXd::Zero(count, count);
    normal.gradient = Eigen::VectorXd::Zero(count);
    normal.view_chi2.resize(parameters.center.size());
    normal.view_pixels.resize(parameters.center.size());
    SampleRow row;
    for (const FilterSample& sample : samples) {
        fill_row(sample, parameters, pitch_m, row);
        const double weight = 1.0 / (static_cast<double>(sample.sigma) * sample.sigma);
        const double residual = sample.transmission - row.value;
        for (std::size_t i = 0; i < row.index.size(); ++i) {
            normal.gradient[row.index[i]] += weight * row.slope[i] * residual;
            for (std::size_t j = 0; j < row.index.size(); ++j)
                normal.matrix(row.index[i], row.index[j]) += weight * row.slope[i] * row.slope[j];
        }
        const double chi2 = weight * residual * residual;
        normal.chi2 += chi2;
        normal.view_chi2[static_cast<std::size_t>(sample.view)] += chi2;
        ++normal.view_pixels[static_cast<std::size_t>(sample.view)];
    }
    for (const Condition& condition : conditions) {
        Eigen::VectorXd now = Eigen::VectorXd::Zero(count);
        for (std::size_t c = 0; c < parameters.cells.size(); ++c) {
            for (std::size_t power = 0; power < 3; ++power)
                now[parameters.cell_index(c) + static_cast<int>(power)] =
                    parameters.cells[c][power];
        }
        const double missing = condition.wanted - condition.row.dot(now);
        normal.matrix += kConditionWeight * condition.row * condition.row.transpose();
        normal.gradient += kConditionWeight * missing * condition.row;
        normal.conditions_chi2 += kConditionWeight * missing * missing;
    }
    return normal;
}

}  // namespace nearfield::calibrate
