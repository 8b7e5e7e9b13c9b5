// SPDX-License-Identifier: Apache-2.0
/// Settings that are not taken on faith.
#pragma once

#include "acquire/camera.h"

#include <span>

namespace nearfield::acquire {

/// Cameras round exposures to their line time; more than this is another exposure.
constexpr double kExposureRounding = 0.01;

/// Throws Error if the camera's value is not the one asked for: clamped, or refused silently.
void check_taken(const std::string& setting, double asked, double got, double tolerance_rel);

/// Asks for an exposure; returns what the camera says it has. Throws Error where that is another.
double set_exposure_checked(Camera& camera, double exposure_us);

/// How many frames after a change of exposure still have the old one. Needs light: a step between
/// neighbors of the bracket by which the frame's mean changes.
///
/// Throws  Error where no step changes anything: the camera ignores exposure, or sees no light.
/// Cost    up to 9 frames a step of the bracket; mostly the first step tells.
int camera_latency(Camera& camera,
                   std::span<const double> exposures_us,
                   const ShouldStop& should_stop);

}  // namespace nearfield::acquire
