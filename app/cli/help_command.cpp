#include "app/cli/commands.h"
#include "app/cli/output.h"

namespace ivory {

void run(const HelpText& help) { Output("-").write(help.text); }

}  // namespace ivory
