// SPDX-License-Identifier: Apache-2.0
#include "app/calibration_page.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace nearfield::app {
namespace {

using calibrate::RadiometryResult;
using report::Curve;
using report::Marks;
using report::Plot;
using report::Section;

constexpr double kPercent = 100.0;

Plot transfer_plot(const calibrate::NoiseResult& noise) {
    Plot plot{
        "Photon transfer: noise against light", "light above black, DN", "variance, DN^2", {}};
    Curve points{"pairs of flats", {}, {}, Marks::Circles};
    Curve line{"read noise^2 + light / gain", {}, {}};
    for (const calibrate::TransferPoint& point : noise.points) {
        points.x.push_back(point.signal_dn);
        points.y.push_back(point.variance_dn2);
        line.x.push_back(point.signal_dn);
        line.y.push_back(noise.read_noise_dn * noise.read_noise_dn +
                         point.signal_dn / noise.gain_e_per_dn);
    }
    plot.curves = {std::move(line), std::move(points)};
    return plot;
}

Plot linearity_plot(const calibrate::FlatResult& flat) {
    Plot plot{"Linearity: rate of an even source against its level",
              "light above dark, DN",
              "deviation from the mean rate, %",
              {}};
    Curve points{"exposures of the flats, with one sigma", {}, {}, Marks::Dots};
    for (const calibrate::LinearityPoint& point : flat.linearity)
        if (point.is_used) {
            points.x.push_back(point.signal_dn);
            points.y.push_back(kPercent * point.deviation_rel);
            points.y_low.push_back(kPercent * (point.deviation_rel - point.sigma_rel));
            points.y_high.push_back(kPercent * (point.deviation_rel + point.sigma_rel));
        }
    plot.curves = {std::move(points)};
    return plot;
}

Section sensor_section(const RadiometryResult& result) {
    Section section{"The sensor", {}, {}, {}, {}};
    const rig::Radiometry& radiometry = result.radiometry;
    section.paragraphs.push_back(
        fmt::format("{} bits, mosaic {}. Gain {:.3f} +- {:.3f} e-/DN, read noise {:.2f} DN, values "
                    "from {:.0f} DN "
                    "on are not used{}. {} hot and {} dead pixels are left out.",
                    radiometry.bits, radiometry.mosaic, radiometry.gain_e_per_dn,
                    radiometry.gain_sigma, radiometry.read_noise_dn, radiometry.saturation_dn,
                    result.saturation.is_full_well ? " (full wells, below the range's end)" : "",
                    result.dark.hot_pixels, result.flat ? result.flat->dead_pixels : 0));
    if (result.noise)
        add_drawing(section, draw(transfer_plot(*result.noise),
                                  "Differences of two frames of the same exposure, by level."));
    if (result.flat && result.flat->linearity.size() > 1)
        add_drawing(section, draw(linearity_plot(*result.flat),
                                  "Rates of the same source at different exposures."));
    report::Table darks{
        "Darks", {"exposure, us", "frames", "mean, DN", "noise of a value, DN"}, {}};
    for (const calibrate::DarkPoint& point : result.dark.points)
        darks.rows.push_back({fmt::format("{:g}", point.exposure_us),
                              fmt::format("{}", point.frames), fmt::format("{:.3f}", point.mean_dn),
                              fmt::format("{:.2f}", point.noise_dn)});
    if (!darks.rows.empty())
        section.tables.push_back(std::move(darks));
    report::Table exposures{"True exposures", {"asked for, us", "true, us", "sigma, %"}, {}};
    for (const rig::TrueExposure& exposure : radiometry.exposures)
        exposures.rows.push_back({fmt::format("{:g}", exposure.asked_us),
                                  fmt::format("{:.5g}", exposure.true_us),
                                  fmt::format("{:.3f}", kPercent * exposure.sigma_rel)});
    if (!exposures.rows.empty())
        section.tables.push_back(std::move(exposures));
    return section;
}

// A map of pixels as means over blocks, so that a page stays small.
report::HeatMap block_map(const std::vector<float>& values,
                          glm::ivec2 size_px,
                          const std::string& title,
                          const std::string& label) {
    constexpr int kBlocks = 96;
    report::HeatMap map;
    map.title = title;
    map.x_label = "x, px";
    map.y_label = "y, px";
    map.value_label = label;
    map.upper = glm::dvec2(size_px);
    map.flip_y = true;
    map.size = glm::min(size_px, glm::ivec2(kBlocks));
    map.picture_px = {760, 560};
    std::vector<double> sums(static_cast<std::size_t>(map.size.x) *
                             static_cast<std::size_t>(map.size.y));
    std::vector<int> counts(sums.size());
    for (std::size_t k = 0; k < values.size(); ++k) {
        const auto width = static_cast<std::size_t>(size_px.x);
        const auto column = k % width * static_cast<std::size_t>(map.size.x) / width;
        const auto row =
            k / width * static_cast<std::size_t>(map.size.y) / static_cast<std::size_t>(size_px.y);
        const std::size_t block = row * static_cast<std::size_t>(map.size.x) + column;
        sums[block] += double(values[k]);
        ++counts[block];
    }
    map.low = 1e300;
    map.high = -1e300;
    for (std::size_t block = 0; block < sums.size(); ++block) {
        map.values.push_back(sums[block] / std::max(1, counts[block]));
        map.low = std::min(map.low, map.values.back());
        map.high = std::max(map.high, map.values.back());
    }
    return map;
}

Section lens_light_section(const RadiometryResult& result) {
    Section section{"The lens' light", {}, {}, {}, {}};
    if (result.flat)
        add_drawing(section,
                    draw(block_map(result.maps.response, result.maps.size_px,
                                   "Response to an even source", "relative"),
                         "Vignetting and the pixels' own response, means over blocks. How even the "
                         "source itself is cannot be told from it."));
    if (result.veil.is_significant) {
        section.paragraphs.push_back(fmt::format(
            "{:.3f} +- {:.3f} % of the light arrives spread by {:.0f} +- {:.0f} px (one sigma of a "
            "gaussian); it is taken off.",
            kPercent * result.veil.share, kPercent * result.veil.share_sigma, result.veil.sigma_px,
            result.veil.sigma_sigma_px));
        Plot plot{"The lens' veil: how well a width explains what dark pixels see",
                  "width, px",
                  "chi-square",
                  {}};
        Curve curve{"chi-square", {}, {}, Marks::Dots};
        for (const calibrate::VeilPoint& point : result.veil.points) {
            curve.x.push_back(point.sigma_px);
            curve.y.push_back(point.chi2);
        }
        plot.curves = {std::move(curve)};
        plot.log_y = true;
        add_drawing(section, draw(plot, "The least is taken."));
    }
    return section;
}

Section response_section(const calibrate::ResponseCurve& response) {
    Section section{"The photographs' response", {}, {}, {}, {}};
    Plot plot{"Response, recovered from the bracket", "value", "light, relative to value 128", {}};
    const std::vector<std::string> colors =
        response.linear.size() == 3 ? std::vector<std::string>{"#c02020", "#208020", "#2020c0"}
                                    : std::vector<std::string>{"#404040"};
    for (std::size_t channel = 0; channel < response.linear.size(); ++channel) {
        Curve curve{colors.size() == 3 ? std::string(1, "RGB"[channel]) : "gray",
                    response.linear[channel].x, response.linear[channel].y};
        curve.color = colors[channel];
        plot.curves.push_back(std::move(curve));
    }
    plot.log_y = true;
    add_drawing(section, draw(plot, "After Debevec and Malik, made monotone."));
    return section;
}

Curve profile_curve(const std::string& name, const std::vector<calibrate::ProfilePoint>& points) {
    Curve curve{name, {}, {}, Marks::Dots};
    for (const calibrate::ProfilePoint& point : points) {
        curve.x.push_back(point.x);
        curve.y.push_back(point.value);
        curve.y_low.push_back(point.value - point.sigma);
        curve.y_high.push_back(point.value + point.sigma);
    }
    return curve;
}

Section filter_section(const calibrate::FilterProfileResult& filter) {
    Section section{"The filter", {}, {}, {}, {}};
    std::string peaks;
    for (std::size_t color = 0; color < filter.peak.size(); ++color)
        peaks += fmt::format("{}{:.4f} +- {:.4f}", color == 0 ? "" : ", ", filter.peak[color],
                             filter.peak_sigma[color]);
    section.paragraphs.push_back(
        fmt::format("Transmission at its center {}. Its profile is up to {:.2f} % of the peak off "
                    "the nominal one "
                    "({:.1f} sigma), and differs along x and y by {:.2f} % ({:.1f} sigma).",
                    peaks, kPercent * filter.nominal_deviation, filter.nominal_sigmas,
                    kPercent * filter.asymmetry, filter.asymmetry_sigmas));
    Plot plot{"Transmission along the filter's axes",
              "distance from the center, pitches",
              "transmission, relative to the center",
              {}};
    plot.curves.push_back(profile_curve("along x", filter.along_x));
    plot.curves.push_back(profile_curve("along y", filter.along_y));
    Curve fitted{"fitted", {}, {}};
    for (const calibrate::ProfilePoint& point : filter.along_x) {
        fitted.x.push_back(point.x);
        fitted.y.push_back(point.fitted);
    }
    plot.curves.push_back(std::move(fitted));
    add_drawing(section, draw(plot, "All views of the filter together."));
    return section;
}

Section scale_section(const RadiometryResult& result) {
    Section section{"From numbers to lux", {}, {}, {}, {}};
    if (!result.scale) {
        section.paragraphs.emplace_back(
            "No photometer: the light is relative (docs/calibration.md says what is needed).");
        return section;
    }
    const calibrate::ScaleResult& scale = *result.scale;
    section.paragraphs.push_back(
        fmt::format("1 DN/s is {:.5g} lx on S, +- {:.3f} % random (the photometer's noise), +- "
                    "{:.2g} % systematic "
                    "(its V(lambda) mismatch and calibration; averaging does not help). Chi-square "
                    "{:.0f} of {}. "
                    "Room light {:.3g} +- {:.2g} lx.",
                    scale.scale_lx_s_per_dn, kPercent * scale.sigma_rel,
                    kPercent * result.radiometry.scale_systematic_rel, scale.chi2, scale.freedom,
                    scale.offset_lx, scale.offset_sigma_lx));
    Plot plot{"Photometer against camera",
              "camera about the photometer's point, DN/s",
              "photometer, lx",
              {}};
    Curve points{"frames", {}, {}, Marks::Circles};
    Curve line{"fitted", {}, {}};
    double most = 0;
    for (const calibrate::ScalePoint& point : scale.points) {
        points.x.push_back(point.light_dn_per_s);
        points.y.push_back(point.reading_lx);
        most = std::max(most, point.light_dn_per_s);
    }
    line.x = {0, most};
    line.y = {scale.offset_lx, scale.offset_lx + scale.scale_lx_s_per_dn * most};
    plot.curves = {std::move(line), std::move(points)};
    add_drawing(section, draw(plot, "Every frame with a reading."));
    return section;
}

}  // namespace

std::vector<Section> radiometry_sections(const RadiometryResult& result) {
    std::vector<Section> sections;
    if (result.response)
        sections.push_back(response_section(*result.response));
    else
        sections.push_back(sensor_section(result));
    if (result.flat)
        sections.push_back(lens_light_section(result));
    if (result.filter)
        sections.push_back(filter_section(*result.filter));
    sections.push_back(scale_section(result));
    sections.push_back(
        {"Parameters of the radiometry", {}, {}, {parameter_table(result.parameters)}, {}});
    return sections;
}

}  // namespace nearfield::app
