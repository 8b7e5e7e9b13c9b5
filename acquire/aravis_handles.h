// SPDX-License-Identifier: Apache-2.0
/// Owners of Aravis' objects, and its errors as ours.
#pragma once

#include "acquire/camera.h"

#include <arv.h>

#include <memory>
#include <string>

namespace nearfield::acquire {

struct Unref {
    void operator()(gpointer object) const { g_object_unref(object); }
};
template <typename Object>
using Handle = std::unique_ptr<Object, Unref>;

/// Receives a call's GError and throws it as Error: DeviceLost where the device did not answer.
class Failure {
  public:
    Failure(std::string what, std::string where)
        : what_(std::move(what)), where_(std::move(where)) {}
    ~Failure() { g_clear_error(&error_); }
    Failure(const Failure&) = delete;
    Failure& operator=(const Failure&) = delete;

    GError** to() { return &error_; }
    explicit operator bool() const { return error_ != nullptr; }
    /// Throws if the call failed.
    void check() const {
        if (error_ == nullptr)
            return;
        const bool is_lost = error_->domain == ARV_DEVICE_ERROR &&
                             (error_->code == ARV_DEVICE_ERROR_TIMEOUT ||
                              error_->code == ARV_DEVICE_ERROR_NOT_CONNECTED ||
                              error_->code == ARV_DEVICE_ERROR_TRANSFER_ERROR ||
                              // A camera that started anew in between does not know us.
                              error_->code == ARV_DEVICE_ERROR_PROTOCOL_ERROR_ACCESS_DENIED);
        if (is_lost)
            throw DeviceLost{what_, where_, "the device to answer", error_->message};
        throw Error{what_, where_, "", error_->message};
    }

  private:
    std::string what_, where_;
    GError* error_ = nullptr;
};

}  // namespace nearfield::acquire
