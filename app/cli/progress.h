// How far the work has come, on standard error where that is a terminal.
#pragma once

#include <string>

namespace ivory {

class Progress {
  public:
    // Shows nothing at all if `quiet`, or where standard error is not a terminal.
    explicit Progress(bool quiet);
    ~Progress();  // wipes what it has shown
    Progress(const Progress&) = delete;
    Progress& operator=(const Progress&) = delete;

    // In place of what was shown before. One line, short.
    void show(const std::string& line);

    // Left standing.
    void leave(const std::string& line);

  private:
    bool visible_;
    bool shown_ = false;
};

}  // namespace ivory
