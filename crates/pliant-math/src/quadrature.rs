//! Quadrature rules on [0, 1].

/// Points and weights on [0, 1]; the weights sum to 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rule<const N: usize> {
    /// Points, ascending.
    pub xi: [f64; N],
    /// Weights.
    pub weight: [f64; N],
}

impl<const N: usize> Rule<N> {
    /// Points with their weights.
    #[must_use]
    pub fn pairs(&self) -> [(f64, f64); N] {
        std::array::from_fn(|k| (self.xi[k], self.weight[k]))
    }
}

/// Gauss, 1 point, exact to degree 1.
pub const GAUSS_1: Rule<1> = Rule { xi: [0.5], weight: [1.0] };

/// Gauss, 2 points, exact to degree 3.
pub const GAUSS_2: Rule<2> =
    Rule { xi: [0.211_324_865_405_187_1, 0.788_675_134_594_812_9], weight: [0.5, 0.5] };

/// Gauss, 3 points, exact to degree 5.
pub const GAUSS_3: Rule<3> = Rule {
    xi: [0.112_701_665_379_258_31, 0.5, 0.887_298_334_620_741_7],
    weight: [5.0 / 18.0, 8.0 / 18.0, 5.0 / 18.0],
};

/// Gauss, 4 points, exact to degree 7.
pub const GAUSS_4: Rule<4> = Rule {
    xi: [
        0.069_431_844_202_973_71,
        0.330_009_478_207_571_9,
        0.669_990_521_792_428_1,
        0.930_568_155_797_026_3,
    ],
    weight: [
        0.173_927_422_568_726_93,
        0.326_072_577_431_273_1,
        0.326_072_577_431_273_1,
        0.173_927_422_568_726_93,
    ],
};

/// Gauss, 5 points, exact to degree 9.
pub const GAUSS_5: Rule<5> = Rule {
    xi: [
        0.046_910_077_030_668,
        0.230_765_344_947_158_45,
        0.5,
        0.769_234_655_052_841_5,
        0.953_089_922_969_332,
    ],
    weight: [
        0.118_463_442_528_094_54,
        0.239_314_335_249_683_23,
        64.0 / 225.0,
        0.239_314_335_249_683_23,
        0.118_463_442_528_094_54,
    ],
};

/// Gauss, 7 points, exact to degree 13.
pub const GAUSS_7: Rule<7> = Rule {
    xi: [
        0.025_446_043_828_620_74,
        0.129_234_407_200_302_77,
        0.297_077_424_311_301_4,
        0.5,
        0.702_922_575_688_698_5,
        0.870_765_592_799_697_2,
        0.974_553_956_171_379_3,
    ],
    weight: [
        0.064_742_483_084_434_85,
        0.139_852_695_744_638_32,
        0.190_915_025_252_559_46,
        0.208_979_591_836_734_7,
        0.190_915_025_252_559_46,
        0.139_852_695_744_638_32,
        0.064_742_483_084_434_85,
    ],
};

/// Lobatto, 3 points (Simpson), exact to degree 3.
pub const LOBATTO_3: Rule<3> =
    Rule { xi: [0.0, 0.5, 1.0], weight: [1.0 / 6.0, 4.0 / 6.0, 1.0 / 6.0] };

#[cfg(test)]
mod tests {
    use super::*;

    fn check<const N: usize>(rule: Rule<N>, degree: i32) {
        let error = |k: i32| {
            let sum: f64 = (0..N).map(|i| rule.weight[i] * rule.xi[i].powi(k)).sum();
            (sum - 1.0 / f64::from(k + 1)).abs()
        };
        for k in 0..=degree {
            assert!(error(k) < 1e-15, "{N} points, degree {k}: {}", error(k));
        }
        assert!(error(degree + 1) > 1e-9, "{N} points are exact beyond {degree}");
    }

    #[test]
    fn exact_to_the_stated_degree_and_no_further() {
        check(GAUSS_1, 1);
        check(GAUSS_2, 3);
        check(GAUSS_3, 5);
        check(GAUSS_4, 7);
        check(GAUSS_5, 9);
        check(GAUSS_7, 13);
        check(LOBATTO_3, 3);
    }
}
