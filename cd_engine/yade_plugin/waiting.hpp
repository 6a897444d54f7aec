// Who waits for a run, who has paused it, and what has ended it. cd_engine/run_hooks.py calls these functions.
#pragma once

#include <string>

namespace cd_engine {

// Whether somebody waits for the run to end: O.run(n, True) or O.wait(). Meanwhile only the scene's engines look at the scene.
bool awaited();
void waitBegins();
void waitEnds();
// Another thread has paused the run. Until the next run begins, whoever looks at the scene must see the last step.
void pauseBegins();
void runBegins();
// YADE forgets the error of a run that has ended before somebody begins to wait for it. So it is kept here until it is taken or the next run begins.
void keepError(const std::string&);
std::string takeError(); // empty: there is none

} // namespace cd_engine
