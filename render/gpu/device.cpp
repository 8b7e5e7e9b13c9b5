// SPDX-License-Identifier: Apache-2.0
#include "render/gpu/device.h"

#include "formats/files/error.h"
#include "render/gpu/objects.h"
#include "render/limits.h"
#include "render/report.h"

#include <epoxy/gl.h>
#include <fmt/format.h>

#include <chrono>
#include <utility>

namespace nearfield::render::gpu {
namespace {

double clock_s() {
    return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch())
        .count();
}

std::string text_of(GLenum name) {
    const auto* text = reinterpret_cast<const char*>(glGetString(name));
    return text == nullptr ? "" : text;
}

const char* name_of_error(GLenum error) {
    switch (error) {
        case GL_OUT_OF_MEMORY:
            return "out of memory";
        case GL_INVALID_ENUM:
            return "invalid enum";
        case GL_INVALID_VALUE:
            return "invalid value";
        case GL_INVALID_OPERATION:
            return "invalid operation";
        case GL_INVALID_FRAMEBUFFER_OPERATION:
            return "incomplete framebuffer";
        default:
            return "unknown error";
    }
}

// Errors alone: performance hints and notes are not for users.
void GLAPIENTRY on_message(GLenum /*source*/,
                           GLenum type,
                           GLuint /*id*/,
                           GLenum /*severity*/,
                           GLsizei length,
                           const GLchar* text,
                           const void* message) {
    auto* kept = static_cast<std::string*>(const_cast<void*>(message));
    if (type == GL_DEBUG_TYPE_ERROR && kept->empty())
        kept->assign(text, length < 0 ? std::char_traits<char>::length(text)
                                      : static_cast<std::size_t>(length));
}

/// Gives a pass its name as long as it runs.
class Named {
  public:
    Named(std::string& kept, const std::string& name)
        : kept_(kept), before_(std::exchange(kept, name)) {}
    ~Named() { kept_ = before_; }
    Named(const Named&) = delete;
    Named& operator=(const Named&) = delete;

  private:
    std::string& kept_;
    std::string before_;
};

/// The card's clock; ended also where the pass throws, since no other can run beside it.
class TimerQuery {
  public:
    TimerQuery() : query_(make()) { glBeginQuery(GL_TIME_ELAPSED, query_.id()); }
    ~TimerQuery() {
        if (is_running_)
            glEndQuery(GL_TIME_ELAPSED);
    }
    TimerQuery(const TimerQuery&) = delete;
    TimerQuery& operator=(const TimerQuery&) = delete;

    double end_s() {
        glEndQuery(GL_TIME_ELAPSED);
        is_running_ = false;
        GLuint64 nanoseconds = 0;
        glGetQueryObjectui64v(query_.id(), GL_QUERY_RESULT, &nanoseconds);
        return 1e-9 * static_cast<double>(nanoseconds);
    }

  private:
    static GLuint make() {
        GLuint id = 0;
        glCreateQueries(GL_TIME_ELAPSED, 1, &id);
        return id;
    }

    Query query_;
    bool is_running_ = true;
};

std::string mebibytes(double bytes) {
    return fmt::format("{:.1f} MiB", bytes / (1024.0 * 1024.0));
}

}  // namespace

Device::Device() : renderer_(text_of(GL_RENDERER)) {
    glGetIntegerv(GL_MAX_TEXTURE_SIZE, &max_texture_px_);
    glGetIntegerv(GL_MAX_ARRAY_TEXTURE_LAYERS, &max_layers_);
    GLint64 most = 0;
    glGetInteger64v(GL_MAX_SHADER_STORAGE_BLOCK_SIZE, &most);
    max_buffer_bytes_ = static_cast<std::uint64_t>(most);
    is_on_cpu_ = renderer_.find("llvmpipe") != std::string::npos ||
                 renderer_.find("softpipe") != std::string::npos;
    glEnable(GL_DEBUG_OUTPUT);
    glEnable(GL_DEBUG_OUTPUT_SYNCHRONOUS);
    glDebugMessageCallback(on_message, &message_);
    glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
    glPixelStorei(GL_PACK_ALIGNMENT, 1);
}

Device::~Device() {
    glDebugMessageCallback(nullptr, nullptr);
}

void Device::check(const std::string& pass) {
    const GLenum error = glGetError();
    if (error == GL_NO_ERROR && message_.empty())
        return;
    throw Error{"the graphics driver reports an error", "pass '" + pass + "' on " + renderer_,
                "none", said(error)};
}

std::string Device::place_of(const std::string& what) const {
    return pass_.empty() ? fmt::format("{} on {}", what, renderer_)
                         : fmt::format("{} in pass '{}' on {}", what, pass_, renderer_);
}

void Device::check_room(const std::string& what, std::uint64_t bytes) const {
    constexpr std::uint64_t kSmall = std::uint64_t{1} << 20U;  // not worth a look
    if (!is_on_cpu_ || bytes < kSmall)
        return;
    const double available = available_memory_bytes();
    if (static_cast<double>(bytes) > available)
        throw Error{"out of graphics memory, which is the machine's here", place_of(what),
                    "at most " + mebibytes(available), mebibytes(static_cast<double>(bytes))};
}

void Device::check_allocation(const std::string& what, std::uint64_t bytes) {
    const GLenum error = glGetError();
    if (error == GL_OUT_OF_MEMORY)
        throw Error{
            "out of graphics memory", place_of(what),
            fmt::format("room for {} beside {} in use", mebibytes(static_cast<double>(bytes)),
                        mebibytes(static_cast<double>(allocated_bytes_))),
            said(error)};
    if (error != GL_NO_ERROR || !message_.empty())
        throw Error{"the graphics driver reports an error", place_of(what), "none", said(error)};
}

std::string Device::said(unsigned error) {
    std::string text = std::exchange(message_, {});
    while (!text.empty() && (text.back() == '\n' || text.back() == ' '))
        text.pop_back();
    while (glGetError() != GL_NO_ERROR) {
    }
    if (error != GL_NO_ERROR)
        text = name_of_error(error) + (text.empty() ? "" : ": " + text);
    return text;
}

void Device::continue_or_stop() const {
    if (is_stopped_ && is_stopped_())
        throw Stopped{};
}

void Device::run_pass(const std::string& name, const std::function<void()>& pass) {
    continue_or_stop();
    const std::uint64_t bytes_before = allocated_bytes_;
    const Named named(pass_, name);
    double time_s = 0.0;
    if (!is_on_cpu_) {
        TimerQuery timer;
        pass();
        time_s = timer.end_s();
    } else {
        const double start_s = clock_s();
        pass();
        glFinish();
        time_s = clock_s() - start_s;
    }
    check(name);
    costs_.push_back({name, time_s, allocated_bytes_ - bytes_before});
}

}  // namespace nearfield::render::gpu
