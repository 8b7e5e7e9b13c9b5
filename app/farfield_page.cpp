// SPDX-License-Identifier: Apache-2.0
#include "app/farfield_page.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace nearfield::app {
namespace {

using farfield::NearFarMap;

std::string meters(double distance_m) {
    return std::isfinite(distance_m) ? fmt::format("{:.3g} m", distance_m) : "farther than tried";
}

report::HeatMap map_of(const NearFarMap& map, std::vector<double> values) {
    report::HeatMap heat;
    heat.x_label = "towards +x, degrees";
    heat.y_label = "towards +y, degrees";
    heat.lower = glm::dvec2(-map.half_angle_deg);
    heat.upper = glm::dvec2(map.half_angle_deg);
    heat.size = {map.size, map.size};
    heat.values = std::move(values);
    heat.picture_px = {640, 560};
    return heat;
}

report::HeatMap intensity_map(const NearFarMap& map, const char* unit) {
    report::HeatMap heat = map_of(map, map.intensity);
    heat.title = "Intensity from afar";
    heat.value_label = unit;
    heat.high = *std::max_element(map.intensity.begin(), map.intensity.end());
    return heat;
}

}  // namespace

std::string farfield_text(const NearFarMap& map, const std::string& stand_in) {
    std::string text = fmt::format(
        "center of the light ({:.4g}, {:.4g}, {:.4g}) m, lamp size {:.4g} m, directions to {:.3g} "
        "deg\n",
        map.center_m.x, map.center_m.y, map.center_m.z, map.lamp_size_m, map.half_angle_deg);
    for (std::size_t k = 0; k < map.errors.size(); ++k)
        text += fmt::format(
            "{} errs by less than {:>2.0f} % beyond {} for half of the light, {} for 95 %\n",
            stand_in, 100 * map.errors[k], meters(map.median_m[k]), meters(map.p95_m[k]));
    return text;
}

std::string farfield_csv(const NearFarMap& map, Quantity quantity) {
    const char* unit = quantity == Quantity::Photometric ? "cd" : "w_sr";
    std::string text = fmt::format("h_deg,v_deg,intensity_{0},sigma_{0}", unit);
    for (const double error : map.errors)
        text += fmt::format(",within_{:.0f}_percent_beyond_m", 100 * error);
    text += "\n";
    const auto size = static_cast<std::size_t>(map.size);
    const auto angle_deg = [&](std::size_t at) {
        return map.half_angle_deg * (2.0 * static_cast<double>(at) / (map.size - 1) - 1);
    };
    for (std::size_t n = 0; n < map.intensity.size(); ++n) {
        text += fmt::format("{:.6g},{:.6g},{:.9g},{:.4g}", angle_deg(n % size), angle_deg(n / size),
                            map.intensity[n], map.sigma[n]);
        for (const std::vector<double>& distances : map.distance_m)
            text += std::isnan(distances[n]) ? "," : fmt::format(",{:.6g}", distances[n]);
        text += "\n";
    }
    return text;
}

report::HeatMap distance_map(const NearFarMap& map, std::size_t k, const std::string& stand_in) {
    std::vector<double> values = map.distance_m[k];
    double low = 0, high = 0;
    for (double& value : values) {
        if (!std::isfinite(value)) {
            value = std::nan("");
            continue;
        }
        low = low == 0 ? value : std::min(low, value);
        high = std::max(high, value);
    }
    report::HeatMap heat = map_of(map, std::move(values));
    heat.title = fmt::format("Beyond this distance {} errs by less than {:.0f} %", stand_in,
                             100 * map.errors[k]);
    heat.value_label = "m";
    heat.low = low;
    heat.high = std::max(high, 1.01 * low);
    heat.log_scale = high > 10 * low && low > 0;
    return heat;
}

report::Page farfield_page(const NearFarMap& map,
                           Quantity quantity,
                           const std::string& lamp,
                           const std::string& stand_in) {
    report::Section section;
    section.title = fmt::format("From which distance on {} stands for the lamp", stand_in);
    section.paragraphs = {fmt::format(
        "On a surface that faces the center of the light, illuminance by {} is compared "
        "with the light field's own; blank: darker than 1 % of the peak, or off by more "
        "at 1024 lamp sizes still.",
        stand_in)};
    section.preformatted = farfield_text(map, stand_in);
    section.columns = 2;
    const auto add = [&section](const report::HeatMap& heat) {
        if (auto image = draw(heat, heat.title))
            section.images.push_back(std::move(*image));
    };
    for (std::size_t k = 0; k < map.errors.size(); ++k)
        add(distance_map(map, k, stand_in));
    add(intensity_map(map, quantity == Quantity::Photometric ? "cd" : "W/sr"));
    if (section.images.empty())
        section.paragraphs.emplace_back("No maps: gnuplot is not installed.");
    return {fmt::format("Near and far field of {}", lamp),
            "How far away a far-field description of the lamp may be used.",
            {section}};
}

}  // namespace nearfield::app
