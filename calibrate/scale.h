// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "calibrate/exposure_ratios.h"

#include <optional>
#include <span>
#include <vector>

namespace nearfield::calibrate {

/// A light frame and what the photometer said during it.
struct ScalePoint {
    glm::ivec2 position{-1};
    double exposure_us = 0;  // asked for; 0: the lamp is off
    double light_dn_per_s = 0,
           sigma = 0;  // about the photometer's point, luminance, sigma of counts
    double reading_lx = 0;
    double residual_sigmas = 0;
};

/// reading = scale light + offset.
struct ScaleResult {
    double scale_lx_s_per_dn = 1, sigma_rel = 0;  // random
    double offset_lx = 0, offset_sigma_lx = 0;    // room light: with the lamp off as well
    double chi2 = 0;
    int freedom = 0;
    std::vector<ScalePoint> points;
};

/// Where and how the photometer looks.
struct PhotometerPlace {
    glm::dvec2 at_px{0};
    double radius_px = 4;       // of the disk whose light is fitted by a plane
    double view_angle_rad = 0;  // between the screen's normal and the camera
    double reading_sigma_rel = 0.003;
};

/// Light about the photometer's point in every frame that has a reading, neither saturated nor
/// without a true exposure: dark, veil and response taken off, colors to luminance, divided by the
/// screen's factor. Lamp off: readings at light 0.
///
/// Cost    reads every frame of the brackets once.
std::vector<ScalePoint> scale_points_of(std::span<const Bracket> brackets,
                                        std::span<const ExposureGroup> darks,
                                        const PixelLayout& layout,
                                        const DarkResult& dark,
                                        const rig::Radiometry& radiometry,
                                        const rig::Maps& maps,
                                        const PhotometerPlace& place,
                                        const FrameReader& read);

/// Weighted straight line; readings' errors are relative, with a floor from the scatter of the
/// lamp-off readings; light's own are counts'. The lamp's drift cancels: both were taken at once.
/// None where there are fewer than three readings of light. sigma_rel is scaled up where chi-square
/// is above its freedom.
std::optional<ScaleResult> fit_scale(std::vector<ScalePoint> points, double reading_sigma_rel);

/// A light frame as light in DN/s: what fit sees too. NaN: saturated or a bad pixel.
std::vector<float> light_of(const capture::Frame& frame,
                            const capture::FrameRecord& record,
                            const PixelLayout& layout,
                            const rig::Radiometry& radiometry,
                            const rig::Maps& maps);

}  // namespace nearfield::calibrate
