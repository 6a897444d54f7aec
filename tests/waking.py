"""O.run(n, True) looks every 40 ms whether the steps are made. The tests wait some thousand times, so it is woken to look every millisecond."""
import functools
import signal
import threading


@functools.cache  # once
def often(omega):
    """Have O.run(n, True) return soon after its last step; omega: the class of yade.O."""
    run, main = omega.run, threading.main_thread().ident
    if threading.get_ident() != main:
        return  # a busy machine may have put a worker of pytest-xdist into another thread: its tests wait longer

    def run_woken(self, nSteps=-1, wait=False):
        def wake():
            while not over.wait(1e-3):
                signal.pthread_kill(main, signal.SIGUSR2)  # ends the sleep, nothing else

        if not wait or threading.get_ident() != main:
            return run(self, nSteps, wait)
        over = threading.Event()
        waker = threading.Thread(target=wake)
        waker.start()
        try:
            return run(self, nSteps, True)
        finally:
            over.set()
            waker.join()

    signal.signal(signal.SIGUSR2, lambda *_: None)
    run_woken.__name__, run_woken.__doc__ = run.__name__, run.__doc__
    omega.run = run_woken
