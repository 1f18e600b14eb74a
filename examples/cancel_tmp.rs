//! Temporary.
use pathwright::{Model, Observer, Plate, Settings, Slicer};
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};
fn main() {
    let settings = Settings::load(&["standard-job"]).unwrap();
    let plate = Plate::new(&settings).add(Model::read(std::env::args().nth(1).unwrap()).unwrap()).unwrap();
    let begun = Instant::now();
    Slicer::new(&settings).threads(0).slice(&plate, &Observer::none()).unwrap();
    let whole = begun.elapsed();
    let mut worst = Duration::ZERO;
    for i in 1..20 {
        let stop = AtomicBool::new(false);
        let wait = whole * i / 20;
        let late = std::thread::scope(|scope| {
            let run = scope.spawn(|| {
                let r =
                    Slicer::new(&settings).threads(0).slice(&plate, &Observer::none().cancelled_by(&stop));
                (r.is_err(), Instant::now())
            });
            std::thread::sleep(wait);
            stop.store(true, Ordering::Relaxed);
            let set = Instant::now();
            let (err, end) = run.join().unwrap();
            println!(
                "{wait:?}: {} after {:?}",
                if err { "cancelled" } else { "done" },
                end.saturating_duration_since(set)
            );
            end.saturating_duration_since(set)
        });
        worst = worst.max(late);
    }
    println!("whole {whole:?}, worst {worst:?}");
}
