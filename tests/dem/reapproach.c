/* a.out SEQUENCES: random impacts, loads, and reversals of the velocity during a contact. Prints how
   many contacts ended, and the largest gain of energy over the largest kinetic energy. */
#include <stdio.h>
#include <stdlib.h>
#include "restitution_contact.h"

static unsigned long long seed = 1;

static double draw(void)
{
    seed = seed * 6364136223846793005ULL + 1442695040888963407ULL;
    return (double)(seed >> 11) / 9007199254740992.0;
}

int main(int count, char **given)
{
    const restitution_pair *p = &restitution_pairs[0];
    const double m = p->mass, low = p->work[0], high = p->work[p->works - 1];
    double worst = -1.0;
    long k, n, ended = 0;
    for (k = 0; k < (count > 1 ? atol(given[1]) : 100000); ++k) {
        const double V = sqrt(2.0 / m * low * pow(high / low, 1.2 * draw() - 0.1));
        const double steps = 20.0 * pow(50.0, draw());
        const double time = 2.87 * pow(m * m / (p->radius * p->modulus * p->modulus * V), 0.2);
        const double dt = time / steps, chance = draw() * draw() * 4.0 / steps;
        const double load = draw() < 0.3 ? draw() * draw() * 0.5 * m * V / time : 0.0;
        double x = -draw() * V * dt, v = V, gain = 0.0, scale = 0.5 * m * V * V;
        restitution_contact c;
        memset(&c, 0, sizeof c);
        for (n = 0; n < 30 * steps && (c.branch != 0 || n < 3); ++n) {
            const double before = v;
            double force;
            x += v * dt;
            force = restitution_normal(p, &c, x, v, dt);
            if (!(fabs(force) < 1e300))
                return printf("not a number\n"), 1;
            v += (load - force) / m * dt;
            if (draw() < chance)
                v *= 0.9 * (1.0 - 2.0 * draw());
            gain -= 0.5 * force * dt * (before + v);
            scale = 0.5 * m * v * v > scale ? 0.5 * m * v * v : scale;
        }
        if (c.branch == 0) {
            ++ended;
            worst = gain / scale > worst ? gain / scale : worst;
        }
    }
    printf("%ld %.3g\n", ended, worst);
    return 0;
}
