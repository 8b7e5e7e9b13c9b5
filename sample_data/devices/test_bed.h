// SPDX-License-Identifier: Apache-2.0
/// umockdev's test bed: a folder that stands for /dev and /sys in processes that load
/// libumockdev-preload, with sockets through which their ioctls come here.
#pragma once

#include <umockdev.h>

#include <functional>
#include <memory>
#include <string>

namespace nearfield::devices {

struct Unref {
    void operator()(gpointer object) const { g_object_unref(object); }
};
template <typename Object>
using Handle = std::unique_ptr<Object, Unref>;

/// One per process. Make it before anything asks umockdev_in_mock_environment(). Sets UMOCKDEV_DIR,
/// which children inherit.
class TestBed {
  public:
    TestBed();

    UMockdevTestbed* get() const { return bed_.get(); }
    std::string root() const;
    /// Adds a device by umockdev's description. Throws Error where it is refused.
    void add(const std::string& description);

  private:
    Handle<UMockdevTestbed> bed_;
};

/// Answers one ioctl on a node: completes the client's call. Called by umockdev's thread, one at a
/// time for all devices.
using AnswerIoctl = std::function<void(UMockdevIoctlClient*)>;

/// What a request's argument points to, loaded from the client; null where it points to nothing, or
/// where the client was killed in the midst of its call. One that is killed a little later gives
/// zeros.
Handle<UMockdevIoctlData> load_argument(UMockdevIoctlClient* client);

/// Somebody who opened a node, until the node is closed or they die. An address alone could be the
/// next one's, at the same place in memory.
class ClientRef {
  public:
    ClientRef() = default;
    explicit ClientRef(UMockdevIoctlClient* client);

    bool is(const UMockdevIoctlClient* client) const { return get().get() == client; }
    bool is_gone() const { return get() == nullptr; }

  private:
    Handle<UMockdevIoctlClient> get() const;

    std::shared_ptr<GWeakRef> weak_;
};

/// A node whose ioctls are answered by us, as long as it lives.
class IoctlNode {
  public:
    IoctlNode(TestBed& bed, const std::string& path, AnswerIoctl answer);
    ~IoctlNode();
    IoctlNode(const IoctlNode&) = delete;
    IoctlNode& operator=(const IoctlNode&) = delete;

  private:
    static gboolean on_ioctl(UMockdevIoctlBase* base, UMockdevIoctlClient* client, gpointer node);

    TestBed& bed_;
    std::string path_;
    AnswerIoctl answer_;
    Handle<UMockdevIoctlBase> base_;
};

}  // namespace nearfield::devices
