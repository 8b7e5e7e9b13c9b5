// SPDX-License-Identifier: Apache-2.0
#include "render/gpu/headless.h"

#include "formats/files/error.h"

#include <epoxy/egl.h>
#include <fmt/format.h>

#include <array>

namespace nearfield::render::gpu {
namespace {

Error no_context(const char* step) {
    return {
        "no OpenGL 4.5 context",
        fmt::format("{} failed with EGL error 0x{:x}", step, eglGetError()),
        "a driver for OpenGL 4.5 with EGL (Debian: libegl1 and libgl1-mesa-dri render on the CPU)",
        "none"};
}

// Mesa gives a display without any device by its own platform, NVIDIA by the device's.
EGLDisplay open_display() {
    if (epoxy_has_egl_extension(EGL_NO_DISPLAY, "EGL_MESA_platform_surfaceless")) {
        EGLDisplay display =
            eglGetPlatformDisplayEXT(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, nullptr);
        if (display != EGL_NO_DISPLAY && eglInitialize(display, nullptr, nullptr) == EGL_TRUE)
            return display;
    }
    if (!epoxy_has_egl_extension(EGL_NO_DISPLAY, "EGL_EXT_device_enumeration"))
        throw no_context("a search for a device");
    std::array<EGLDeviceEXT, 16> devices{};
    EGLint count = 0;
    eglQueryDevicesEXT(static_cast<EGLint>(devices.size()), devices.data(), &count);
    for (EGLint k = 0; k < count; ++k) {
        EGLDisplay display = eglGetPlatformDisplayEXT(
            EGL_PLATFORM_DEVICE_EXT, devices[static_cast<std::size_t>(k)], nullptr);
        if (display != EGL_NO_DISPLAY && eglInitialize(display, nullptr, nullptr) == EGL_TRUE)
            return display;
    }
    throw no_context("eglInitialize");
}

}  // namespace

struct HeadlessContext::Egl {
    EGLDisplay display = EGL_NO_DISPLAY;
    EGLContext context = EGL_NO_CONTEXT;

    ~Egl() {
        if (display == EGL_NO_DISPLAY)
            return;
        eglMakeCurrent(display, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
        if (context != EGL_NO_CONTEXT)
            eglDestroyContext(display, context);
        eglTerminate(display);
    }
};

HeadlessContext::HeadlessContext() : egl_(std::make_unique<Egl>()) {
    egl_->display = open_display();
    if (eglBindAPI(EGL_OPENGL_API) != EGL_TRUE)
        throw no_context("eglBindAPI");
    constexpr std::array<EGLint, 9> kAttributes = {EGL_CONTEXT_MAJOR_VERSION,
                                                   4,
                                                   EGL_CONTEXT_MINOR_VERSION,
                                                   5,
                                                   EGL_CONTEXT_OPENGL_PROFILE_MASK,
                                                   EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT,
                                                   EGL_CONTEXT_OPENGL_DEBUG,
                                                   EGL_TRUE,  // or messages may be left out
                                                   EGL_NONE};
    egl_->context =
        eglCreateContext(egl_->display, EGL_NO_CONFIG_KHR, EGL_NO_CONTEXT, kAttributes.data());
    if (egl_->context == EGL_NO_CONTEXT)
        throw no_context("eglCreateContext");
    if (eglMakeCurrent(egl_->display, EGL_NO_SURFACE, EGL_NO_SURFACE, egl_->context) != EGL_TRUE)
        throw no_context("eglMakeCurrent");
}

HeadlessContext::~HeadlessContext() = default;

}  // namespace nearfield::render::gpu
