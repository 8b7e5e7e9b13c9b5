// SPDX-License-Identifier: Apache-2.0
#include "formats/files/error.h"
#include "render/cpu/render.h"
#include "tests/render/pictures.h"
#include "tests/render/scenes.h"

#include <gtest/gtest.h>

#include <string>

namespace nearfield::render {
namespace {

using test::floor_scene;
using test::small;

// Proves that options out of range and a missing camera are refused by name.
TEST(Limits, OptionsOutOfRangeAreRefused) {
    const auto message = [](const Scene& scene, const RenderOptions& options) -> std::string {
        try {
            render_cpu(scene, options);
        } catch (const Error& error) {
            return error.what();
        }
        return "no error";
    };
    const auto expect = [&](const char* text, const auto& change) {
        RenderOptions options = small();
        change(options);
        EXPECT_NE(message(floor_scene(), options).find(text), std::string::npos) << text;
    };
    expect("samples per pixel", [](RenderOptions& o) { o.samples_per_pixel = 5; });
    expect("samples", [](RenderOptions& o) { o.samples = 1; });
    expect("q", [](RenderOptions& o) { o.q = -1; });
    expect("q", [](RenderOptions& o) {
        o.q = 8;
        o.sampler = model::Sampler::Cells;
    });
    expect("error", [](RenderOptions& o) { o.error_rel = 1.0; });
    expect("time", [](RenderOptions& o) { o.time_s = -1.0; });
    expect("'rear'", [](RenderOptions& o) { o.camera = "rear"; });
}

}  // namespace
}  // namespace nearfield::render
