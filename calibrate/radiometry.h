// SPDX-License-Identifier: Apache-2.0
/// How a bench's values follow light, from a capture: the radiometric half of calibration.
///
/// Three steps, so that the geometric half can come between them: the sensor needs no geometry,
/// the filter needs lens and plane U (and gives the stage's positions), the scale needs the
/// photometer's place in the picture.
#pragma once

#include "calibrate/filter_profile.h"
#include "calibrate/flat_field.h"
#include "calibrate/noise.h"
#include "calibrate/observations.h"
#include "calibrate/response.h"
#include "calibrate/scale.h"
#include "calibrate/stray.h"
#include "calibrate/veil_fit.h"
#include "formats/capture/capture.h"
#include "formats/rig/rig.h"

#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace nearfield::calibrate {

struct RadiometryOptions {
    /// Without darks: take this black level and no dark current, and say so. Else they are refused.
    std::optional<double> assumed_black_dn;
    double hot_sigmas = 6;               // a pixel is hot beyond; lower: more pixels left out
    double dead_rel = 0.25;              // a pixel is dead that far from its neighbors
    double unknown_ratio_rel = 0.02;     // sigma of an exposure that could not be compared
    double psf_sigma_px = 0.7;           // of the lens, for the filter's edges
    glm::dmat3 rgb_from_raw{1.0};        // linear Rec.709 from white-balanced raw colors
    rig::Curve screen;                   // luminance factor against the angle of view, rad
    double photometer_correction = 1;    // what its readings are multiplied by
    double photometer_mismatch_rel = 0;  // systematic
};

/// Something that people should know, and what to do about it.
struct Flag {
    std::string what, advice;
};

struct RadiometryResult {
    PixelLayout layout;
    rig::Radiometry radiometry;
    rig::Maps maps;
    DarkResult dark;
    std::optional<NoiseResult> noise;
    Saturation saturation;
    std::optional<FlatResult> flat;
    VeilResult veil;
    RatioResult ratios;
    std::optional<ResponseCurve> response;  // of photographs alone
    std::optional<FilterProfileResult> filter;
    std::optional<ScaleResult> scale;
    StrayResult stray;
    std::vector<rig::Parameter> parameters;
    std::vector<Flag> flags;
    double time_s = 0;
};

/// What a plan says of the lab's parts.
RadiometryOptions options_from(const capture::Plan& plan);

/// From 0 to 1 within a step.
using RadiometryProgress = std::function<void(const std::string& step, double fraction)>;

/// Frames of a capture by what they are for; pointers into it.
struct SortedFrames {
    std::vector<ExposureGroup> darks, flats;  // by exposure
    std::vector<ExposureGroup> filters;       // by position of the filter that is looked at
    std::vector<const capture::FrameRecord*> targets;
    std::vector<Bracket> brackets;  // a position and repeat each, ascending in exposure
};

SortedFrames sorted_frames(const capture::Capture& capture);

/// Black, dark, noise, saturation, response of pixels, linearity, veil, true exposures.
///
/// Photographs of unknown response (CaptureHeader) have their response recovered from the brackets
/// instead, and nothing else.
///
/// Throws  Error for missing darks (unless assumed) or flats, flats all dark or saturated, frames
///         of different kinds, lights all saturated, photographs without a bracket.
/// Cost    reads flats three times, boards six times, everything else once; memory some twenty
///         values a pixel, whatever the number of frames.
RadiometryResult calibrate_sensor(const capture::Capture& capture,
                                  const FrameReader& read,
                                  const RadiometryOptions& options,
                                  const RadiometryProgress& progress);

/// The filter's profile, from frames that show it against the flats' source; their centers for the
/// geometric half. `nominal` has the number of cells.
std::vector<FilterView> measure_filter(std::span<const ExposureGroup> views,
                                       const FilterGeometry& geometry,
                                       const Profile& nominal,
                                       const FrameReader& read,
                                       RadiometryResult& result);

/// Lux for DN/s, room light, light beside the filter. Without a photometer's place or readings the
/// light stays relative, and a flag says so.
void measure_scale(const capture::Capture& capture,
                   const std::optional<PhotometerPlace>& photometer,
                   const RadiometryOptions& options,
                   const FrameReader& read,
                   const RadiometryProgress& progress,
                   RadiometryResult& result);

/// Reads frames from a capture's folder.
FrameReader reader_of(const std::string& folder);

}  // namespace nearfield::calibrate
