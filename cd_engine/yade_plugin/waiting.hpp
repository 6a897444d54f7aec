// Who waits for a run, and who has paused it (cd_engine/__init__.py tells).
#pragma once

namespace cd_engine {

// Whether somebody waits for the run to end: O.run(n, True) or O.wait(). Nobody looks at the scene meanwhile but its engines.
bool awaited();
void waitBegins();
void waitEnds();
// Another thread has paused the run: whoever looks now sees the last step; until the next run begins.
void pauseBegins();
void runBegins();

} // namespace cd_engine
