//! The CPUs that workers run on.
//!
//! Linux may leave a new thread on the CPU of the one that started it, and put one that wakes on the CPU of the one that woke it, for
//! 4 to 20 ms although another has nothing to do (measured with 6.18 as a guest of KVM, where a CPU that sleeps looks taken): as long
//! as slicing a small model takes.

#[cfg(all(feature = "system", target_os = "linux"))]
mod system {
    use std::sync::atomic::{AtomicUsize, Ordering};
    use std::sync::{Mutex, MutexGuard, PoisonError};

    use nix::sched::{CpuSet, sched_getaffinity, sched_getcpu, sched_setaffinity};
    use nix::unistd::{Pid, gettid};

    /// The workers of one pool that have begun, each with a CPU of its own as long as there are any.
    #[derive(Default)]
    pub struct Cpus {
        workers: Mutex<Vec<Worker>>,
        begun: AtomicUsize,
    }

    struct Worker {
        thread: Pid,
        /// Where it may run.
        allowed: CpuSet,
        own: Option<usize>,
    }

    impl Cpus {
        /// Makes the calling thread a worker, and moves it to a CPU that no other has, if there is one.
        pub fn begin(&self) {
            let mut workers = self.workers();
            let thread = gettid();
            // A worker that may not choose begins where it is.
            let allowed = sched_getaffinity(thread).unwrap_or_default();
            let own = begin_beside(&workers, &allowed).ok().flatten();
            workers.push(Worker { thread, allowed, own });
            drop(workers);
            self.begun.fetch_add(1, Ordering::Relaxed);
        }

        /// How many workers have begun. Nobody is waited for.
        pub fn begun(&self) -> usize {
            self.begun.load(Ordering::Relaxed)
        }

        /// Keeps each of them off the CPUs of the others from now on, so that two do not share one.
        pub fn keep_apart(&self) {
            let workers = self.workers();
            for worker in workers.iter().filter(|worker| worker.own.is_some()) {
                let others = workers.iter().filter(|other| other.thread != worker.thread);
                // One that may not stays where the system puts it.
                let _ =
                    without(&worker.allowed, others).and_then(|own| sched_setaffinity(worker.thread, &own));
            }
        }

        fn workers(&self) -> MutexGuard<'_, Vec<Worker>> {
            self.workers.lock().unwrap_or_else(PoisonError::into_inner)
        }
    }

    fn without<'a>(allowed: &CpuSet, others: impl Iterator<Item = &'a Worker>) -> nix::Result<CpuSet> {
        let mut free = *allowed;
        for cpu in others.filter_map(|other| other.own) {
            free.unset(cpu)?;
        }
        Ok(free)
    }

    fn begin_beside(others: &[Worker], allowed: &CpuSet) -> nix::Result<Option<usize>> {
        let free = without(allowed, others.iter())?;
        if free == CpuSet::new() {
            return Ok(None);
        }
        let cpu = sched_getcpu()?;
        if free.is_set(cpu)? {
            return Ok(Some(cpu));
        }
        let this = Pid::from_raw(0);
        sched_setaffinity(this, &free)?;
        let own = sched_getcpu();
        sched_setaffinity(this, allowed)?;
        own.map(Some)
    }

    #[cfg(test)]
    mod tests {
        use std::collections::BTreeSet;
        use std::sync::Barrier;
        use std::thread;

        use super::*;

        fn allowed() -> Vec<usize> {
            let set = sched_getaffinity(Pid::from_raw(0)).unwrap();
            (0..CpuSet::count()).filter(|&cpu| set.is_set(cpu) == Ok(true)).collect()
        }

        #[test]
        fn workers_have_cpus_of_their_own_as_long_as_there_are_any() {
            let all = allowed().len();
            for count in 1..=all + 1 {
                let cpus = Cpus::default();
                let (begun, apart) = (Barrier::new(count + 1), Barrier::new(count + 1));
                let work = || {
                    cpus.begin();
                    begun.wait();
                    apart.wait();
                    allowed()
                };
                let runs_on: Vec<Vec<usize>> = thread::scope(|scope| {
                    let workers: Vec<_> = (0..count).map(|_| scope.spawn(work)).collect();
                    begun.wait();
                    assert_eq!(cpus.begun(), count);
                    cpus.keep_apart();
                    apart.wait();
                    workers.into_iter().map(|worker| worker.join().unwrap()).collect()
                });
                // Its own, and what is nobody's; those that have none of their own may use all.
                let owners = count.min(all);
                let mut sizes: Vec<usize> = runs_on.iter().map(Vec::len).collect();
                sizes.sort_unstable();
                assert_eq!(sizes, [vec![all + 1 - owners; owners], vec![all; count - owners]].concat());
                let used: BTreeSet<usize> = runs_on.concat().into_iter().collect();
                assert_eq!(used.len(), all, "{runs_on:?}");
            }
        }
    }
}

#[cfg(not(all(feature = "system", target_os = "linux")))]
mod system {
    /// The workers of one pool: the system's affair.
    #[derive(Default)]
    pub struct Cpus {}

    impl Cpus {
        /// Nothing: workers begin where the system lets them.
        pub fn begin(&self) {}

        /// Nothing: they run where the system lets them.
        pub fn keep_apart(&self) {}

        /// Nobody has to be waited for.
        pub fn begun(&self) -> usize {
            usize::MAX
        }
    }
}

pub(super) use system::Cpus;
