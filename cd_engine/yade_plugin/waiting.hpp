// Who waits for a run, and who has paused it. cd_engine/__init__.py calls these functions.
#pragma once

namespace cd_engine {

// Whether somebody waits for the run to end: O.run(n, True) or O.wait(). Meanwhile only the scene's engines look at the scene.
bool awaited();
void waitBegins();
void waitEnds();
// Another thread has paused the run. Until the next run begins, whoever looks at the scene must see the last step.
void pauseBegins();
void runBegins();

} // namespace cd_engine
