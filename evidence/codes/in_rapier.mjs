// needs @dimforge/rapier3d-compat@0.21.0
// e of a sphere of 1 m on a box, by restitution, velocity, time step and combination rule.
import RAPIER from "@dimforge/rapier3d-compat";
await RAPIER.init();
function rebound(e1, e2, V, step, rule) {
  const world = new RAPIER.World({x: 0, y: 0, z: 0});
  world.timestep = step;
  const floor = world.createCollider(RAPIER.ColliderDesc.cuboid(50, 1, 50).setTranslation(0, -1, 0).setRestitution(e2));
  const body = world.createRigidBody(RAPIER.RigidBodyDesc.dynamic().setCanSleep(false).setTranslation(0, 1 + 0.37 * V * step + 0.1, 0).setLinvel(0, -V, 0));
  const ball = RAPIER.ColliderDesc.ball(1).setRestitution(e1);
  if (rule !== undefined) ball.setRestitutionCombineRule(rule);
  world.createCollider(ball, body);
  for (let n = 0; n < 0.3 / V / step + 50; ++n) world.step();
  const v = body.linvel().y;
  world.free();
  return v / V;
}
console.log("RESULT rapier", RAPIER.version());
for (const e of [1, 0.8, 0.5, 0.2])
  for (const V of [0.05, 1, 5]) {
    const row = [1 / 60, 1 / 240, 1 / 1000].map((step) => rebound(e, e, V, step).toFixed(4));
    console.log(`RESULT e ${e} of both, ${V} m/s, steps of 1/60, 1/240, 1/1000 s: ${row.join(", ")}`);
  }
const rules = RAPIER.CoefficientCombineRule;
for (const name of ["Average", "Min", "Multiply", "Max"])
  console.log(`RESULT 0.8 and 0.4, ${name}: ${rebound(0.8, 0.4, 1, 1 / 240, rules[name]).toFixed(4)}`);
