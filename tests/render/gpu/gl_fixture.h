// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "render/gpu/device.h"
#include "render/gpu/headless.h"

#include <gtest/gtest.h>

#include <memory>

namespace nearfield::render::gpu {

/// One headless context for all tests of a suite. Without one they fail: a machine that cannot
/// render by OpenGL has not tested the OpenGL renderer.
class GlTest : public testing::Test {
  protected:
    static void SetUpTestSuite();
    static void TearDownTestSuite();

    Device& device() { return *device_; }

  private:
    static std::unique_ptr<HeadlessContext> context_;
    static std::unique_ptr<Device> device_;
};

}  // namespace nearfield::render::gpu
