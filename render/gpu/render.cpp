// SPDX-License-Identifier: Apache-2.0
#include "render/gpu/render.h"

#include "render/gpu/session.h"

namespace nearfield::render {

Rendered render_gl(const Scene& scene, const RenderOptions& options, const RenderHooks& hooks) {
    const Call call = begin_call(options, hooks);
    gpu::Session session;
    return session.render(scene, options, call);
}

}  // namespace nearfield::render
