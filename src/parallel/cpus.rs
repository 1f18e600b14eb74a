//! The CPUs that workers run on.
//!
//! Linux may leave a new thread on the CPU of the one that started it, and put one that wakes on the CPU of the one that woke it, for
//! 4 to 20 ms although another has nothing to do (measured with 6.18 as a guest of KVM, where a CPU that sleeps looks taken): as long
//! as slicing a small model takes.

#[cfg(all(feature = "system", target_os = "linux"))]
mod system {
    use std::fs;
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
            keep_apart(&self.workers());
        }

        fn workers(&self) -> MutexGuard<'_, Vec<Worker>> {
            self.workers.lock().unwrap_or_else(PoisonError::into_inner)
        }
    }

    /// How many CPUs the calling thread may use, if so few that its process's share of their time does not matter: that takes as
    /// long to read as a thread to start.
    pub fn few() -> Option<usize> {
        const FEW: usize = 2;
        let allowed = sched_getaffinity(gettid()).ok()?;
        Some(members(&allowed).take(FEW + 1).count()).filter(|&count| count <= FEW)
    }

    fn members(cpus: &CpuSet) -> impl Iterator<Item = usize> {
        (0..CpuSet::count()).filter(|&cpu| cpus.is_set(cpu) == Ok(true))
    }

    /// Moves the calling thread's process apart: it stays where it is, and each other thread gets a CPU of its own, as long as there
    /// are any. They need not have begun.
    pub fn spread() {
        // Without the list each begins where the system lets it, and so where one may not choose.
        let threads = fs::read_dir("/proc/self/task").into_iter().flatten().flatten();
        let ids = threads.filter_map(|thread| thread.file_name().to_str()?.parse().ok());
        let this = gettid();
        let _ = place(this, ids.map(Pid::from_raw).filter(|thread| *thread != this));
    }

    fn place(this: Pid, others: impl Iterator<Item = Pid>) -> nix::Result<()> {
        let (allowed, own) = (sched_getaffinity(this)?, sched_getcpu()?);
        let free = members(&allowed).filter(|&cpu| cpu != own);
        let others = others.zip(free).chain([(this, own)]);
        let workers: Vec<Worker> =
            others.map(|(thread, cpu)| Worker { thread, allowed, own: Some(cpu) }).collect();
        keep_apart(&workers);
        Ok(())
    }

    /// Keeps each off the CPUs of the others.
    fn keep_apart(workers: &[Worker]) {
        for worker in workers.iter().filter(|worker| worker.own.is_some()) {
            let others = workers.iter().filter(|other| other.thread != worker.thread);
            // One that may not stays where the system puts it.
            let _ = without(&worker.allowed, others).and_then(|own| sched_setaffinity(worker.thread, &own));
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
            members(&set).collect()
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

        #[test]
        fn threads_are_put_on_cpus_that_no_other_has_by_the_one_that_starts_them() {
            let all = allowed();
            let others = Mutex::new(Vec::new());
            let [begun, placed, done] = [(); 3].map(|()| Barrier::new(all.len() + 1));
            let wait = || {
                placed.wait();
                let runs_on = allowed();
                done.wait();
                runs_on
            };
            let work = || {
                others.lock().unwrap().push(gettid());
                begun.wait();
                wait()
            };
            // The one that places them has a thread of its own, as it is kept in its place, too.
            let places = || {
                begun.wait();
                place(gettid(), others.lock().unwrap().drain(..)).unwrap();
                wait()
            };
            let mut runs_on: Vec<Vec<usize>> = thread::scope(|scope| {
                let others: Vec<_> = all.iter().map(|_| scope.spawn(work)).collect();
                let own = scope.spawn(places).join().unwrap();
                others.into_iter().map(|other| other.join().unwrap()).chain([own]).collect()
            });
            // One more than there are CPUs may use all.
            let free = runs_on.iter().position(|cpus| *cpus == all).unwrap();
            runs_on.remove(free);
            assert!(runs_on.iter().all(|cpus| cpus.len() == 1), "{runs_on:?}");
            let used: BTreeSet<usize> = runs_on.concat().into_iter().collect();
            assert_eq!(used.len(), all.len());
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

    /// Not known.
    pub fn few() -> Option<usize> {
        None
    }

    /// Nothing.
    pub fn spread() {}
}

pub(super) use system::{Cpus, few, spread};
