use pathwright::geom::*;
use pathwright::profile::*;
use pathwright::toolpath::*;
use pathwright::units::*;
use std::collections::HashMap;
use std::io::Write;
fn main() {
    let a: Vec<String> = std::env::args().collect();
    let mut f = std::fs::File::open(&a[1]).unwrap();
    let m = stl_io::read_stl(&mut f).unwrap();
    let v: Vec<[f64; 3]> = m.vertices.iter().map(|p| [p[0] as f64, p[1] as f64, p[2] as f64]).collect();
    let lo: Vec<f64> = (0..3).map(|k| v.iter().map(|p| p[k]).fold(1e9, f64::min)).collect();
    let hi: Vec<f64> = (0..3).map(|k| v.iter().map(|p| p[k]).fold(-1e9, f64::max)).collect();
    let v: Vec<[f64; 3]> = v
        .iter()
        .map(|p| [p[0] - (lo[0] + hi[0]) / 2. + 125., p[1] - (lo[1] + hi[1]) / 2. + 125., p[2] - lo[2]])
        .collect();
    let h = 0.2;
    let n = ((hi[2] - lo[2]) / h + 0.5 - 1e-6).floor() as usize;
    let t0 = std::time::Instant::now();
    let mut segs: Vec<Vec<(Point, Point)>> = vec![vec![]; n];
    for f in &m.faces {
        let p = f.vertices.map(|i| v[i]);
        let z0 = p.iter().map(|q| q[2]).fold(1e9, f64::min);
        let z1 = p.iter().map(|q| q[2]).fold(-1e9, f64::max);
        let l0 = (z0 / h - 0.5).ceil().max(0.) as usize;
        for (l, segs) in segs.iter_mut().enumerate().skip(l0) {
            let z = h * (l as f64 + 0.5);
            if z >= z1 {
                break;
            }
            let mut ends = [None, None];
            for k in 0..3 {
                let (q, r) = (p[k], p[(k + 1) % 3]);
                if (q[2] >= z) != (r[2] >= z) {
                    let (s, t) = if (q[2], q[0], q[1]) < (r[2], r[0], r[1]) { (q, r) } else { (r, q) };
                    let w = (z - s[2]) / (t[2] - s[2]);
                    let pt = Point::from_mm(s[0] + w * (t[0] - s[0]), s[1] + w * (t[1] - s[1]));
                    if q[2] >= z { ends[0] = Some(pt) } else { ends[1] = Some(pt) }
                }
            }
            if let [Some(x), Some(y)] = ends
                && x != y
            {
                segs.push((x, y));
            }
        }
    }
    let sections: Vec<Region> = segs
        .iter()
        .map(|s| {
            let mut next: HashMap<Point, Vec<Point>> = HashMap::new();
            for &(a, b) in s {
                next.entry(a).or_default().push(b);
            }
            let mut rings = vec![];
            for &(a, _) in s {
                while let Some(b) = next.get_mut(&a).and_then(|v| v.pop()) {
                    let mut ring = vec![a];
                    let mut c = b;
                    while c != a {
                        ring.push(c);
                        match next.get_mut(&c).and_then(|v| v.pop()) {
                            Some(d) => c = d,
                            None => break,
                        }
                    }
                    if ring.len() > 2 {
                        rings.push(ring);
                    }
                }
            }
            let rings: Vec<Ring> = rings
                .iter()
                .flat_map(|r| {
                    pathwright::geom::simplify(
                        &Region { polygons: vec![Polygon { outer: r.clone(), holes: vec![] }] },
                        0.0125,
                    )
                    .polygons
                    .into_iter()
                    .flat_map(|p| {
                        let mut v = vec![p.outer];
                        v.extend(p.holes);
                        v
                    })
                    .collect::<Vec<_>>()
                })
                .collect();
            let u = unite_rings(&rings);
            if std::env::var("V").is_ok() {
                eprintln!("{} -> {}", s.len(), u.vertex_count());
            }
            u
        })
        .collect();
    eprintln!("slice {:?}", t0.elapsed());
    let mut s = Settings::default();
    s.walls.count = 2;
    s.shell.top_layers = 4;
    s.shell.bottom_layers = 4;
    s.shell.top_width = Mm(0.45);
    s.infill.density = Ratio(a.get(3).map_or(0.2, |d| d.parse().unwrap()));
    s.first_layer.width = Mm(0.);
    if let Ok(o) = std::env::var("OVERLAP") {
        s.infill.overlap = Ratio(o.parse().unwrap());
    }
    let t0 = std::time::Instant::now();
    let refs: Vec<&Region> = sections.iter().collect();
    let shells = Shells::build(&refs, 4, 4, &|n, f| (0..n).map(f).collect());
    eprintln!("shells {:?}", t0.elapsed());
    let empty = Region::default();
    let mk = |i: usize| PlateLayer {
        index: i,
        top_mm: h * (i + 1) as f64,
        height_mm: h,
        objects: vec![ObjectLayer {
            object: 0,
            section: &sections[i],
            next: sections.get(i + 1).unwrap_or(&empty),
            above: shells.above(i),
            below: shells.below(i),
        }],
    };
    let mut pl = Planner::new((&s).into(), &sections[0], h);
    let t0 = std::time::Instant::now();
    let samples: Vec<PlateLayer> = (0..12).map(|k| mk((n - 1) * k / 11)).collect();
    pl.calibrate(&samples, &|n, f| (0..n).map(f).collect());
    eprintln!("calibrate {:?}", t0.elapsed());
    let t0 = std::time::Instant::now();
    let layers: Vec<LayerPaths> = (0..n).map(|i| pl.layer(&mk(i))).collect();
    eprintln!("plan {:?} paths {}", t0.elapsed(), layers.iter().map(|l| l.paths.len()).sum::<usize>());
    let mut out = std::io::BufWriter::new(std::fs::File::create(&a[2]).unwrap());
    writeln!(out, "G90\nM83\nM104 S200").unwrap();
    let fil = std::f64::consts::PI * 0.875 * 0.875;
    for l in &layers {
        writeln!(out, ";LAYER_CHANGE\nG1 Z{:.3} F600", l.top_mm).unwrap();
        let mut role = None;
        for p in &l.paths {
            if role != Some(p.role) {
                writeln!(out, ";TYPE:{}", p.role.type_name()).unwrap();
                role = Some(p.role);
            }
            let q = p.points[0].mm();
            writeln!(out, "G0 X{:.3} Y{:.3} F9000", q[0], q[1]).unwrap();
            let mut pts = p.points.clone();
            if p.closed {
                pts.push(p.points[0]);
            }
            let w = |i: usize| match &p.width {
                Width::Constant(w) => *w,
                Width::PerVertex(v) => v[i % p.points.len()] as f64,
            };
            for i in 1..pts.len() {
                let q = pts[i].mm();
                let e = bead::area_mm2((w(i - 1) + w(i)) / 2., l.height_mm) * pts[i - 1].distance_mm(pts[i])
                    / fil;
                writeln!(out, "G1 X{:.3} Y{:.3} E{:.6} F3000", q[0], q[1], e).unwrap();
            }
        }
    }
}
