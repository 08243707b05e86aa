// EGL without a surface: any Mesa driver, without a display or a window system; drawn into a frame-buffer
// object. The few names used are those of EGL/egl.h and eglext.h, which need not be there.
#include <array>
#include <cstdint>

#include "app/platform/context.h"
#include "app/platform/shared_library.h"
#include "core/scene/error.h"

namespace ivory {

namespace {

using EglHandle = void*;
using EglInt = std::int32_t;
using EglBool = std::uint32_t;

constexpr std::uint32_t egl_platform_surfaceless = 0x31DD, egl_opengl_api = 0x30A2;
constexpr EglInt egl_none = 0x3038, egl_major_version = 0x3098, egl_minor_version = 0x30FB,
                 egl_profile_mask = 0x30FD, egl_core_profile_bit = 1;

class EglContext final : public MemoryContext {
  public:
    explicit EglContext(WindowSize size)
        : library_({"libEGL.so.1"}),
          make_current_(library_.function<MakeCurrent>("eglMakeCurrent")),
          destroy_(library_.function<DestroyContext>("eglDestroyContext")) {
        const auto proc_address = library_.function<GetProcAddress>("eglGetProcAddress");
        const auto platform_display =
            reinterpret_cast<GetPlatformDisplay*>(proc_address("eglGetPlatformDisplayEXT"));
        if (platform_display == nullptr)
            throw Error("EGL has no platforms (EGL_EXT_platform_base)");
        display_ = platform_display(egl_platform_surfaceless, nullptr, nullptr);
        if (display_ == nullptr ||
            !library_.function<Initialize>("eglInitialize")(display_, nullptr, nullptr))
            throw Error("EGL has no surfaceless platform on this machine");
        try {
            // without it the context would be one of OpenGL ES
            if (!library_.function<BindApi>("eglBindAPI")(egl_opengl_api))
                throw Error("EGL has no desktop OpenGL on this machine");
            const std::array<EglInt, 7> attributes = {
                egl_major_version,    3,       egl_minor_version, 3, egl_profile_mask,
                egl_core_profile_bit, egl_none};
            handle_ = library_.function<CreateContext>("eglCreateContext")(
                display_, nullptr, nullptr, attributes.data());
            if (handle_ == nullptr) throw Error("EGL gives no OpenGL 3.3 core context");
            if (!make_current_(display_, nullptr, nullptr, handle_))
                throw Error("EGL refuses a context without a surface");
            gl_ = Gl::load(proc_address);
            gl_.GenFramebuffers(1, &framebuffer_);
            gl_.GenRenderbuffers(1, &color_);
            resize(size);
        } catch (...) {
            close();
            throw;
        }
    }
    ~EglContext() override {
        gl_.DeleteFramebuffers(1, &framebuffer_);
        gl_.DeleteRenderbuffers(1, &color_);
        close();
    }

    const char* name() const override { return "EGL"; }
    const Gl& gl() const override { return gl_; }
    WindowSize size() const override { return size_; }
    GlUint framebuffer() const override { return framebuffer_; }

    void resize(WindowSize size) override {
        gl_.BindRenderbuffer(gl::renderbuffer, color_);
        gl_.RenderbufferStorage(gl::renderbuffer, gl::rgba8, size.width, size.height);
        gl_.BindFramebuffer(gl::framebuffer, framebuffer_);
        gl_.FramebufferRenderbuffer(gl::framebuffer, gl::color_attachment0, gl::renderbuffer,
                                    color_);
        if (gl_.CheckFramebufferStatus(gl::framebuffer) != gl::framebuffer_complete)
            throw Error("EGL refuses a picture of " + std::to_string(size.width) + "x" +
                        std::to_string(size.height));
        size_ = size;
    }

  private:
    using GetProcAddress = Gl::ProcAddress(const char*);
    using GetPlatformDisplay = EglHandle(std::uint32_t, void*, const EglInt*);
    using Initialize = EglBool(EglHandle, EglInt*, EglInt*);
    using BindApi = EglBool(std::uint32_t);
    using CreateContext = EglHandle(EglHandle, EglHandle, EglHandle, const EglInt*);
    using MakeCurrent = EglBool(EglHandle, EglHandle, EglHandle, EglHandle);
    using DestroyContext = EglBool(EglHandle, EglHandle);

    // The display stays: eglTerminate would unload the driver, for which see SharedLibrary.
    void close() {
        make_current_(display_, nullptr, nullptr, nullptr);
        if (handle_ != nullptr) destroy_(display_, handle_);
    }

    SharedLibrary library_;
    MakeCurrent* make_current_;
    DestroyContext* destroy_;
    EglHandle display_ = nullptr;
    EglHandle handle_ = nullptr;
    Gl gl_;
    GlUint framebuffer_ = 0, color_ = 0;
    WindowSize size_;
};

}  // namespace

std::unique_ptr<MemoryContext> open_egl_context(WindowSize size) {
    return std::make_unique<EglContext>(size);
}

}  // namespace ivory
