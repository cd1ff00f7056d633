//! corpus
#![allow(missing_docs, clippy::all)]
use isolux_report::page::*;
use isolux_report::*;
struct R(u64);
impl R {
    fn n(&mut self) -> u64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        self.0
    }
    fn f(&mut self) -> f64 {
        (self.n() >> 11) as f64 / (1u64 << 53) as f64
    }
    fn num(&mut self) -> f64 {
        match self.n() % 24 {
            0 => f64::NAN,
            1 => f64::INFINITY,
            2 => 0.0,
            3 => 1e300,
            4 => -1e300,
            5 => 5e-324,
            6..=9 => 10f64.powf(self.f() * 8.0 - 4.0),
            10 => -self.f(),
            11 => f64::from_bits(self.n()),
            _ => self.f() * 20.0 - 3.0,
        }
    }
    fn tame(&mut self) -> f64 {
        10f64.powf(self.f() * 3.0 - 1.0)
    }
    fn words(&mut self, most: u64) -> String {
        let w = [
            "amplitude",
            "in",
            "DN",
            "<b>",
            "a&b",
            "\"q\"",
            "distance",
            "σ",
            "m",
            "integration",
            "time",
            "\u{1}",
        ];
        (0..self.n() % (most + 1)).map(|_| w[(self.n() % 12) as usize]).collect::<Vec<_>>().join(" ")
    }
    fn axis(&mut self) -> Axis {
        let range = if self.n() % 3 == 0 { Some((self.num(), self.num())) } else { None };
        Axis {
            label: self.words(20),
            scale: if self.n() % 2 == 0 { Scale::Linear } else { Scale::Log },
            range,
        }
    }
}
fn main() {
    let out = std::env::args().nth(1).unwrap();
    let mut r = R(88172645463325252);
    let mut blocks = vec![];
    for i in 0..1500 {
        let tame = i % 2 == 0;
        let series = (0..r.n() % 10)
            .map(|_| {
                let count = match r.n() % 10 {
                    0 => 150,
                    1 if i % 40 == 0 => 1200,
                    _ => r.n() % 14,
                };
                let points = (0..count)
                    .map(|_| if tame { (r.tame(), r.tame()) } else { (r.num(), r.num()) })
                    .collect();
                let stroke = [Stroke::Solid, Stroke::Dashed, Stroke::Points, Stroke::SolidPoints]
                    [(r.n() % 4) as usize];
                Series { name: r.words(3), points, stroke }
            })
            .collect();
        let marks = (0..r.n() % 4)
            .map(|_| Mark {
                axis: if r.n() % 2 == 0 { MarkAxis::X } else { MarkAxis::Y },
                at: if tame { r.tame() } else { r.num() },
                label: r.words(8),
            })
            .collect();
        blocks.push(Block::Chart(Chart {
            id: format!("c{i}"),
            caption: r.words(5),
            alt: r.words(5),
            x: r.axis(),
            y: r.axis(),
            series,
            marks,
        }));
    }
    let page = Page {
        title: "t".into(),
        lead: "l".into(),
        sections: vec![Section { id: "s".into(), title: "S".into(), blocks }],
        colophon: "c".into(),
    };
    write_report(&page, std::path::Path::new(&out), "report.html").unwrap();
}
