// One function a call of the command line. Each does its job or throws: Error where it cannot be
// done, Interrupted where the user has stopped it.
#pragma once

#include "app/cli/arguments.h"

namespace ivory {

void run(const RenderArguments& arguments);
void run(const TraceArguments& arguments);
void run(const InfoArguments& arguments);
void run(const ViewerArguments& arguments);
void run(const HelpText& help);

}  // namespace ivory
