// An OpenGL 3.3 core context with a colour buffer: a window's, or one in memory.
#pragma once

#include <memory>
#include <string>

#include "app/platform/gl.h"
#include "app/platform/input.h"
#include "app/platform/window_rect.h"

namespace ivory {

// Made current on the thread that creates it; every call is made on that thread but `wake`.
class Context {
  public:
    virtual ~Context() = default;
    Context(const Context&) = delete;
    Context& operator=(const Context&) = delete;

    // "GLFW", "OSMesa" or "EGL".
    [[nodiscard]] virtual const char* name() const = 0;
    [[nodiscard]] virtual const Gl& gl() const = 0;
    // Of the colour buffer, in pixels.
    [[nodiscard]] virtual WindowSize size() const = 0;
    // The frame-buffer object that is the colour buffer: 0 is the default one.
    [[nodiscard]] virtual GlUint framebuffer() const { return 0; }
    // The frame is drawn: shows it.
    virtual void present() = 0;

  protected:
    Context() = default;
};

enum class Cursor : unsigned char { arrow, text, hand, move, resize_x, resize_y };

// A context in memory: its size follows `resize`.
class MemoryContext : public Context {
  public:
    // The colour buffer is undefined afterwards. Throws Error where there is no memory for it.
    virtual void resize(WindowSize size) = 0;
    void present() override { gl().Finish(); }
};

// A window: its size follows the user.
class WindowContext : public Context {
  public:
    // Sleeps until something happens, `wake` is called or `seconds` have passed (< 0: for ever), then
    // moves what has happened into `queue`.
    virtual void wait_events(EventQueue& queue, double seconds) = 0;
    virtual void set_title(const std::string& title) = 0;
    // Of the window, in points of the screen.
    [[nodiscard]] virtual WindowSize points() const = 0;
    [[nodiscard]] virtual bool maximised() const = 0;
    // HiDPI scale of the monitor it is on.
    [[nodiscard]] virtual double scale() const = 0;
    // Ends a `wait_events`. From any thread.
    virtual void wake() = 0;
    virtual void set_cursor(Cursor cursor) = 0;
    virtual void set_clipboard(const std::string& text) = 0;
    [[nodiscard]] virtual std::string clipboard() const = 0;
};

// Each throws Error, one line, where the machine cannot.
// OSMesa (libOSMesa.so.8 or .6), loaded at run time.
[[nodiscard]] std::unique_ptr<MemoryContext> open_osmesa_context(WindowSize size);
// EGL without a surface (Mesa's surfaceless platform), loaded at run time; draws into its own object.
[[nodiscard]] std::unique_ptr<MemoryContext> open_egl_context(WindowSize size);
// The first of the two that opens; IVORY_HEADLESS_CONTEXT=osmesa or =egl in the environment chooses.
[[nodiscard]] std::unique_ptr<MemoryContext> open_memory_context(WindowSize size);
// A window on the display, `size` in points of the screen, no larger than the screen has room for;
// without a display the error says how to go on.
[[nodiscard]] std::unique_ptr<WindowContext> open_window_context(WindowSize size, bool maximised,
                                                                 const std::string& title);

}  // namespace ivory
