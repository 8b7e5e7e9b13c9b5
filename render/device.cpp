// SPDX-License-Identifier: Apache-2.0
#include "render/device.h"

#include "formats/files/error.h"
#include "render/cpu/render.h"
#include "render/gpu/headless.h"
#include "render/gpu/render.h"

#include <fmt/format.h>

#include <optional>

namespace nearfield::render {
namespace {

/// Why not by OpenGL; nothing where it can be.
std::optional<std::string> reason_for_cpu(const Scene& scene, const RenderOptions& options) {
    const EnvironmentMethod method = options.environment.method;
    if (scene.environment && options.effects.environment != Switch::Off &&
        (method == EnvironmentMethod::Reference || method == EnvironmentMethod::Resampled))
        return fmt::format("--environment {} traces rays", name_of(method));
    if (options.sigma_measured)
        return "sigma_measured is asked for";
    try {
        const gpu::HeadlessContext context;
        return std::nullopt;
    } catch (const Error& error) {
        return error.what_ + ": " + error.where;
    }
}

Rendered render_auto(const Scene& scene, const RenderOptions& options, const RenderHooks& hooks) {
    const std::optional<std::string> reason = reason_for_cpu(scene, options);
    Rendered rendered =
        reason ? render_cpu(scene, options, hooks) : render_gl(scene, options, hooks);
    rendered.report.device_reason =
        reason ? *reason : std::string("there is an OpenGL 4.5 context");
    return rendered;
}

}  // namespace

Rendered render(const Scene& scene, const RenderOptions& options, const RenderHooks& hooks) {
    switch (options.device) {
        case Device::Auto:
            return render_auto(scene, options, hooks);
        case Device::Gl:
            return render_gl(scene, options, hooks);
        case Device::Cpu:
            break;
    }
    return render_cpu(scene, options, hooks);
}

}  // namespace nearfield::render
