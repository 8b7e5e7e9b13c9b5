// SPDX-License-Identifier: Apache-2.0
/// What the studies of `bench environment` share: a scene with its reference, and rows of pictures
/// against that.
#pragma once

#include "app/bench/environment.h"
#include "formats/scene/scene.h"
#include "render/report.h"

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

namespace nearfield::bench {

/// Frames, numbers and what is known so far.
struct Sweep {
    std::string folder, picture;
    Mesh mesh;
    render::RenderOptions options;  // of all pictures
    int reference_samples = 0;
    std::vector<int> counts;  // of samples
    bool quick = false;
    std::function<void()> step;
    EnvironmentFindings& findings;
};

/// A scene and its reference. With one camera sample a pixel making it adds that one's own noise as
/// a row: two with other random numbers apart.
struct Subject {
    Scene scene;
    std::string study, name;
    std::vector<float> truth;  // r g b where a surface is seen
};
Subject make_subject(Sweep& sweep, Scene scene, const std::string& study, const std::string& name);

/// How light is found; N: of filtered samples, far lamps, directions.
render::EnvironmentOptions filtered(int samples,
                                    int suns,
                                    render::FilterLevel level = render::FilterLevel::Fis);
render::EnvironmentOptions lamps(int count);

/// Adds a row: the subject's picture against its reference.
void measure(Sweep& sweep,
             const Subject& subject,
             const std::string& method,
             int samples,
             const render::EnvironmentOptions& environment,
             bool by_gl = false);

/// The same by as many filtered samples (suns apart) as errors of 0.4 to 0.05 call for; the row's
/// number of samples is their mean.
void measure_by_error(Sweep& sweep, const Subject& subject);

/// By `samples` chosen of 8 times as many.
void measure_resampled(Sweep& sweep, const Subject& subject, int samples);

/// What the environment's passes took.
double environment_s(const render::RenderReport& report);

// The studies.
void sweep_surfaces(Sweep& sweep,
                    const Mesh& mesh,
                    const std::vector<float>& exponents,
                    const std::string& study);
void sweep_counts(Sweep& sweep);
void sweep_brushed(Sweep& sweep);
void sweep_suns(Sweep& sweep);
void sweep_visibility(Sweep& sweep);
void sweep_time(Sweep& sweep);
void compare_maps(Sweep& sweep);

}  // namespace nearfield::bench
