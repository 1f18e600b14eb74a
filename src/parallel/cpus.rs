//! The CPUs that workers begin on.
//!
//! Linux may leave a new thread on the CPU of the one that started it for 4 to 20 ms although another has nothing to do (measured
//! with 6.18): as long as slicing a small model takes.

#[cfg(all(feature = "system", target_os = "linux"))]
mod system {
    use std::sync::atomic::{AtomicUsize, Ordering};
    use std::sync::{Mutex, PoisonError};

    use nix::sched::{CpuSet, sched_getaffinity, sched_getcpu, sched_setaffinity};
    use nix::unistd::Pid;

    /// Those that the workers of one pool have begun on, and how many these are.
    #[derive(Default)]
    pub struct Cpus {
        taken: Mutex<CpuSet>,
        begun: AtomicUsize,
    }

    impl Cpus {
        /// Moves the calling thread to a CPU that no other worker has begun on, if its own is one of those. Where it runs afterwards is
        /// up to the system again.
        pub fn begin(&self) {
            let mut taken = self.taken.lock().unwrap_or_else(PoisonError::into_inner);
            // A worker that may not choose begins where it is.
            let _ = begin_beside(&mut taken);
            self.begun.fetch_add(1, Ordering::Relaxed);
        }

        /// How many workers have begun.
        pub fn begun(&self) -> usize {
            self.begun.load(Ordering::Relaxed)
        }
    }

    fn begin_beside(taken: &mut CpuSet) -> nix::Result<()> {
        let mut cpu = sched_getcpu()?;
        if taken.is_set(cpu)? {
            let this = Pid::from_raw(0);
            let allowed = sched_getaffinity(this)?;
            let mut free = allowed;
            for other in (0..CpuSet::count()).filter(|&other| taken.is_set(other) == Ok(true)) {
                free.unset(other)?;
            }
            if free != CpuSet::new() {
                sched_setaffinity(this, &free)?;
                let own = sched_getcpu();
                sched_setaffinity(this, &allowed)?;
                cpu = own?;
            }
        }
        taken.set(cpu)
    }

    #[cfg(test)]
    mod tests {
        use super::*;

        #[test]
        fn workers_begin_on_cpus_of_their_own_as_long_as_there_are_any() {
            let cpus = Cpus::default();
            let allowed = || sched_getaffinity(Pid::from_raw(0)).unwrap();
            let count =
                |set: &CpuSet| (0..CpuSet::count()).filter(|&cpu| set.is_set(cpu) == Ok(true)).count();
            let all = count(&allowed());
            for workers in 1..=all + 1 {
                let begun = || {
                    cpus.begin();
                    allowed()
                };
                let afterwards = std::thread::scope(|scope| scope.spawn(begun).join().unwrap());
                assert_eq!(count(&cpus.taken.lock().unwrap()), workers.min(all));
                assert_eq!(afterwards, allowed());
            }
        }
    }
}

#[cfg(not(all(feature = "system", target_os = "linux")))]
mod system {
    /// Those that the workers of one pool have begun on: the system's affair.
    #[derive(Default)]
    pub struct Cpus;

    impl Cpus {
        /// Nothing: workers begin where the system lets them.
        pub fn begin(&self) {}

        /// Nobody has to be waited for.
        pub fn begun(&self) -> usize {
            usize::MAX
        }
    }
}

pub(super) use system::Cpus;
