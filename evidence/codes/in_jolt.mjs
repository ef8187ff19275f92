// needs jolt-physics@1.1.0
// e of a sphere of 1 m on a box, by restitution, velocity and time step.
import initJolt from "jolt-physics";
const Jolt = await initJolt();
function rebound(e1, e2, V, rate, threshold = 1) {
  const settings = new Jolt.JoltSettings();
  const pairs = new Jolt.ObjectLayerPairFilterTable(2);
  pairs.EnableCollision(0, 1);
  const broad = new Jolt.BroadPhaseLayerInterfaceTable(2, 2);
  broad.MapObjectToBroadPhaseLayer(0, new Jolt.BroadPhaseLayer(0));
  broad.MapObjectToBroadPhaseLayer(1, new Jolt.BroadPhaseLayer(1));
  settings.mObjectLayerPairFilter = pairs;
  settings.mBroadPhaseLayerInterface = broad;
  settings.mObjectVsBroadPhaseLayerFilter = new Jolt.ObjectVsBroadPhaseLayerFilterTable(broad, 2, pairs, 2);
  const jolt = new Jolt.JoltInterface(settings);
  const system = jolt.GetPhysicsSystem();
  system.SetGravity(new Jolt.Vec3(0, 0, 0));
  const physics = system.GetPhysicsSettings();
  physics.mMinVelocityForRestitution = threshold;
  system.SetPhysicsSettings(physics);
  const bodies = system.GetBodyInterface();
  const make = (shape, y, motion, layer, e, v) => {
    const s = new Jolt.BodyCreationSettings(shape, new Jolt.RVec3(0, y, 0), new Jolt.Quat(0, 0, 0, 1), motion, layer);
    s.mRestitution = e;
    s.mLinearDamping = 0;
    s.mAllowSleeping = false;
    s.mLinearVelocity = new Jolt.Vec3(0, v, 0);
    const body = bodies.CreateBody(s);
    bodies.AddBody(body.GetID(), Jolt.EActivation_Activate);
    return body;
  };
  make(new Jolt.BoxShape(new Jolt.Vec3(50, 1, 50), 0.05), -1, Jolt.EMotionType_Static, 0, e2, 0);
  const ball = make(new Jolt.SphereShape(1), 1.1 + 0.37 * V / rate, Jolt.EMotionType_Dynamic, 1, e1, -V);
  for (let n = 0; n < 0.3 / V * rate + 50; ++n) jolt.Step(1 / rate, 1);
  const v = ball.GetLinearVelocity().GetY();
  Jolt.destroy(jolt);
  return v / V;
}
for (const e of [1, 0.8, 0.5, 0.2])
  for (const V of [0.5, 2, 5]) {
    const row = [60, 240, 1000].map((rate) => rebound(e, e, V, rate).toFixed(4));
    console.log(`RESULT e ${e} of both, ${V} m/s, steps of 1/60, 1/240, 1/1000 s: ${row.join(", ")}`);
  }
console.log(`RESULT 0.8 and 0.4: ${rebound(0.8, 0.4, 2, 240).toFixed(4)}`);
console.log(`RESULT e 0.8, 0.5 m/s, mMinVelocityForRestitution 0.01: ${rebound(0.8, 0.8, 0.5, 240, 0.01).toFixed(4)}`);
