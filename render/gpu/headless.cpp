// SPDX-License-Identifier: Apache-2.0
#include "render/gpu/headless.h"

#include "formats/files/error.h"

#include <epoxy/egl.h>
#include <fmt/format.h>

#include <array>
#include <mutex>

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

struct Display {
    EGLDisplay id = EGL_NO_DISPLAY;

    Display() : id(open_display()) {}
    ~Display() { eglTerminate(id); }
    Display(const Display&) = delete;
    Display& operator=(const Display&) = delete;
};

/// A process has one display of a platform, whoever opens it, and eglTerminate ends it for all:
/// the last context does that.
std::shared_ptr<const Display> shared_display() {
    static std::mutex mutex;
    static std::weak_ptr<const Display> opened;
    const std::lock_guard lock(mutex);
    std::shared_ptr<const Display> display = opened.lock();
    if (!display)
        opened = display = std::make_shared<const Display>();
    return display;
}

}  // namespace

struct HeadlessContext::Egl {
    std::shared_ptr<const Display> display;
    EGLContext context = EGL_NO_CONTEXT;

    ~Egl() {
        if (!display)
            return;
        eglMakeCurrent(display->id, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
        if (context != EGL_NO_CONTEXT)
            eglDestroyContext(display->id, context);
    }
};

HeadlessContext::HeadlessContext() : egl_(std::make_unique<Egl>()) {
    egl_->display = shared_display();
    EGLDisplay display = egl_->display->id;
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
        eglCreateContext(display, EGL_NO_CONFIG_KHR, EGL_NO_CONTEXT, kAttributes.data());
    if (egl_->context == EGL_NO_CONTEXT)
        throw no_context("eglCreateContext");
    if (eglMakeCurrent(display, EGL_NO_SURFACE, EGL_NO_SURFACE, egl_->context) != EGL_TRUE)
        throw no_context("eglMakeCurrent");
}

HeadlessContext::~HeadlessContext() = default;

}  // namespace nearfield::render::gpu
