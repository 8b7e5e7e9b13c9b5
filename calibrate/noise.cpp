// SPDX-License-Identifier: Apache-2.0
#include "calibrate/noise.h"

#include "formats/files/error.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace nearfield::calibrate {
namespace {

constexpr int kTransferBins = 64;
constexpr std::size_t kLeastPairs = 30;  // a variance known to 26 %
constexpr double kCollapsed = 0.7;       // of what the line says
constexpr double kShareOfClip = 0.85;    // of the clipping level: nothing clips below it
constexpr int kReweightings = 5;

struct VarianceLine {
    double read_dn2 = 0, slope_dn = 0;  // variance = read_dn2 + slope_dn * signal
    double read_sigma = 0, slope_sigma = 0;
    double chi2 = 0;
    int points = 0;
};

// Weighted straight line; weights from the line itself, so that low variances are not favored.
VarianceLine fit_line(const std::vector<TransferPoint>& points) {
    VarianceLine line;
    for (int round = 0; round < kReweightings; ++round) {
        double s0 = 0, s1 = 0, s2 = 0, y0 = 0, y1 = 0;
        for (const TransferPoint& point : points) {
            if (!point.is_used)
                continue;
            const double expected =
                round == 0 ? point.variance_dn2 : line.read_dn2 + line.slope_dn * point.signal_dn;
            const double sigma =
                std::max(expected, 1e-6) * std::sqrt(2.0 / static_cast<double>(point.pairs));
            const double weight = 1.0 / (sigma * sigma);
            s0 += weight;
            s1 += weight * point.signal_dn;
            s2 += weight * point.signal_dn * point.signal_dn;
            y0 += weight * point.variance_dn2;
            y1 += weight * point.signal_dn * point.variance_dn2;
        }
        const double determinant = s0 * s2 - s1 * s1;
        line.slope_dn = (s0 * y1 - s1 * y0) / determinant;
        line.read_dn2 = (s2 * y0 - s1 * y1) / determinant;
        line.slope_sigma = std::sqrt(s0 / determinant);
        line.read_sigma = std::sqrt(s2 / determinant);
    }
    for (const TransferPoint& point : points) {
        if (!point.is_used)
            continue;
        const double expected = line.read_dn2 + line.slope_dn * point.signal_dn;
        const double sigma =
            std::max(expected, 1e-6) * std::sqrt(2.0 / static_cast<double>(point.pairs));
        line.chi2 += std::pow((point.variance_dn2 - expected) / sigma, 2.0);
        ++line.points;
    }
    return line;
}

bool has_two_levels(const std::vector<TransferPoint>& points) {
    double least = 1e30, most = -1e30;
    for (const TransferPoint& point : points) {
        if (!point.is_used)
            continue;
        least = std::min(least, point.signal_dn);
        most = std::max(most, point.signal_dn);
    }
    return most > least;
}

// Leaves out what lies at and above the first level whose variance has collapsed.
bool leave_out_collapsed(const VarianceLine& line, std::vector<TransferPoint>& points) {
    bool has_changed = false, is_above = false;
    for (TransferPoint& point : points) {
        const double expected = line.read_dn2 + line.slope_dn * point.signal_dn;
        is_above = is_above || (point.is_used && point.variance_dn2 < kCollapsed * expected &&
                                expected - point.variance_dn2 > 6.0 * point.sigma_dn2);
        has_changed = has_changed || (is_above && point.is_used);
        point.is_used = point.is_used && !is_above;
    }
    return has_changed;
}

}  // namespace

TransferSums::TransferSums(const PixelLayout& layout,
                           std::span<const float> black_dn,
                           std::span<const float> is_bad)
    : black_dn_(black_dn),
      is_bad_(is_bad),
      bin_dn_(layout.range_dn() / kTransferBins),
      range_dn_(layout.range_dn()),
      signal_(kTransferBins + 1),
      squares_(kTransferBins + 1),
      count_(kTransferBins + 1) {}

std::size_t TransferSums::bin_of(double signal_dn) const {
    return static_cast<std::size_t>(std::clamp(signal_dn / bin_dn_, 0.0, double(kTransferBins)));
}

void TransferSums::add(const capture::Frame& first, const capture::Frame& second) {
    double sum_first = 0, sum_second = 0;
    for (std::size_t k = 0; k < first.values.size(); ++k) {
        if (is_bad_[k] != 0.0F)
            continue;
        sum_first += first.values[k] - black_dn_[k];
        sum_second += second.values[k] - black_dn_[k];
    }
    const double mean = 0.5 * (sum_first + sum_second) / static_cast<double>(first.values.size());
    // Of a dark pair the ratio would be noise by noise.
    const double ratio = mean > bin_dn_ ? sum_first / sum_second : 1.0;
    for (std::size_t k = 0; k < first.values.size(); ++k) {
        if (is_bad_[k] != 0.0F || first.values[k] == 0 || second.values[k] == 0)
            continue;
        const double a = first.values[k] - black_dn_[k], b = second.values[k] - black_dn_[k];
        const double difference = a - ratio * b;
        const std::size_t bin = bin_of(0.5 * (a + b));
        signal_[bin] += 0.5 * (a + b);
        squares_[bin] += difference * difference / (1.0 + ratio * ratio);
        ++count_[bin];
    }
}

std::vector<TransferPoint> TransferSums::points() const {
    std::vector<TransferPoint> points;
    for (std::size_t bin = 0; bin < count_.size(); ++bin) {
        if (count_[bin] < kLeastPairs)
            continue;
        const auto n = static_cast<double>(count_[bin]);
        TransferPoint point;
        point.signal_dn = signal_[bin] / n;
        point.variance_dn2 = squares_[bin] / n;
        point.sigma_dn2 = point.variance_dn2 * std::sqrt(2.0 / n);
        point.pairs = count_[bin];
        points.push_back(point);
    }
    return points;
}

void LevelHistogram::add(const capture::Frame& frame) {
    counts.resize(static_cast<std::size_t>(frame.range_dn()) + 1);
    for (const std::uint16_t value : frame.values)
        ++counts[value];
}

NoiseResult noise_of(std::vector<TransferPoint> points, double clip_signal_dn) {
    for (TransferPoint& point : points)
        point.is_used = point.signal_dn < kShareOfClip * clip_signal_dn;
    VarianceLine line;
    do {
        if (!has_two_levels(points))
            throw Error{"cannot find the camera's noise", "flats",
                        "pairs of flats that are neither saturated nor dark, and darks",
                        fmt::format("{} usable levels of brightness",
                                    std::count_if(points.begin(), points.end(),
                                                  [](const auto& p) { return p.is_used; }))};
        line = fit_line(points);
    } while (leave_out_collapsed(line, points));
    if (!(line.slope_dn > 0.0))
        throw Error{"cannot find the camera's noise", "flats", "noise that grows with light",
                    fmt::format("{} DN^2 per DN", line.slope_dn)};
    NoiseResult noise;
    noise.gain_e_per_dn = 1.0 / line.slope_dn;
    noise.gain_sigma = line.slope_sigma / (line.slope_dn * line.slope_dn);
    noise.read_noise_dn = std::sqrt(std::max(0.0, line.read_dn2));
    noise.read_noise_sigma = line.read_sigma / (2.0 * std::max(noise.read_noise_dn, 1e-3));
    noise.chi2 = line.chi2;
    noise.freedom = line.points - 2;
    for (const TransferPoint& point : points)
        noise.most_used_dn = point.is_used ? point.signal_dn : noise.most_used_dn;
    noise.points = std::move(points);
    return noise;
}

Saturation saturation_of(const LevelHistogram& histogram,
                         const PixelLayout& layout,
                         double black_dn,
                         double gain_e_per_dn,
                         double read_noise_dn) {
    constexpr std::uint64_t kLeastCount = 20;
    constexpr double kPileUp = 4.0;  // times what lies beside it: slopes of pictures do not do that
    Saturation found;
    found.clip_dn = layout.range_dn();
    const std::vector<std::uint64_t>& counts = histogram.counts;
    const auto count_in = [&counts](double from, double to) {
        std::uint64_t sum = 0;
        for (auto k = static_cast<std::size_t>(std::max(0.0, from)); double(k) < to; ++k)
            sum += k < counts.size() ? counts[k] : 0;
        return sum;
    };
    // Full wells are read with noise: their values fill a width of 8 sigma below the highest one.
    const double width = std::ceil(8.0 * std::max(read_noise_dn, 0.3)) + 1.0;
    std::size_t highest = counts.size();
    while (highest > 0 && counts[highest - 1] == 0)
        --highest;
    const double top = static_cast<double>(highest);
    if (!counts.empty() && counts.back() >= kLeastCount) {
        found.is_reached = true;
    } else if (count_in(top - width, top) > kLeastCount &&
               double(count_in(top - width, top)) >
                   kPileUp * double(count_in(top - 3.0 * width, top - width)) / 2.0) {
        found.is_reached = found.is_full_well = true;
        std::uint64_t half = count_in(top - width, top) / 2;
        auto level = static_cast<std::size_t>(std::max(0.0, top - width));
        while (half > counts[level])
            half -= counts[level++];
        found.clip_dn = static_cast<double>(level);
    }
    const double signal_dn = std::max(0.0, found.clip_dn - black_dn);
    found.saturation_dn =
        found.clip_dn - 3.0 * std::sqrt(read_noise_dn * read_noise_dn + signal_dn / gain_e_per_dn);
    return found;
}

}  // namespace nearfield::calibrate
