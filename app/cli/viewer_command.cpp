#include "app/cli/commands.h"
#include "core/scene/error.h"

namespace ivory {

void run(const ViewerArguments&) {
    throw Error(
        "this build has no viewer; draw with `ivory render SCENE -o OUT.png`, or see `ivory "
        "--help`");
}

}  // namespace ivory
