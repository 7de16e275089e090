import { authorization, takeToken } from './access.js';
import { Connection } from './connection.js';
import { Controls } from './controls.js';
import { CurveEditor } from './curve_editor.js';
import { Edits } from './edits.js';
import { EnvironmentUpload } from './environment_upload.js';
import { Materials } from './materials.js';
import { Measurements } from './measurements.js';
import { Orbit } from './orbit.js';
import { Toasts } from './toasts.js';
import { Trackball } from './trackball.js';
import { Viewer } from './viewer.js';

const element = (id) => document.getElementById(id);

const token = takeToken(window);

/** ws://HOST/sessions/NAME/stream?scene=NAME, from this page's own ?session=…&scene=…. */
function streamUrl(location) {
  const parameters = new URLSearchParams(location.search);
  const session = encodeURIComponent(parameters.get('session') || 'default');
  const protocol = location.protocol === 'https:' ? 'wss:' : 'ws:';
  const query = new URLSearchParams();
  if (parameters.get('scene')) query.set('scene', parameters.get('scene'));
  if (token) query.set('token', token); // a browser's WebSocket has no headers to set
  const path = `/sessions/${session}/stream`;
  return `${protocol}//${location.host}${path}${String(query) ? `?${query}` : ''}`;
}

const connection = new Connection(streamUrl(window.location));
const edits = new Edits((message) => connection.send(message));
const viewer = new Viewer(element('canvas'), element('stage'));
const measurements = new Measurements(document);
const toasts = new Toasts(element('toasts'));
const controls = new Controls(change);
const materials = new Materials(change);
const uploads = new EnvironmentUpload({
  headers: authorization(token),
  onReady: (name) => change({ environment: name }),
  onError: (text) => toasts.say(text),
});
const curves = new CurveEditor({ headers: authorization(token), onChange: change, onDrop: () => adopt(), onError: (text) => toasts.say(text) });

function onGrab(grabbed) {
  element('canvas').classList.toggle('dragging', grabbed);
  if (!grabbed) adopt();
}

// Before the trackball: it hears keys first, and keeps those that turn the camera.
const orbit = new Orbit(element('canvas'), {
  leads: () => element('drag-camera').checked,
  onView: (camera) => {
    trackball.setCamera(camera ?? sceneCamera);
    send({ view: { camera } });
  },
  onGrab,
});
const trackball = new Trackball(element('canvas'), {
  onTurn: (rotation) => send({ rotation }),
  onGrab,
  isTaken: (event) => orbit.isDragging || orbit.takes(event),
});

let newest = null; // {epoch, revision, state}: what the server said last
let shown = null; // the header of the frame in the canvas
let sceneCamera = null; // where a view starts

element('reset-view').addEventListener('click', () => {
  showView(null);
  send({ view: { camera: null } });
});

function send(part) {
  edits.set(part);
  showBusy();
}

/** Says whether the picture is still on its way to the exact one of all edits. */
function showBusy() {
  const isSettled = shown?.exact && !edits.isBusy && shown.epoch === newest.epoch && shown.revision >= newest.revision;
  element('canvas').ariaBusy = String(!isSettled);
}

function showView(camera) {
  trackball.setCamera(camera ?? sceneCamera);
  orbit.setCamera(camera ?? sceneCamera);
}

function change(part) {
  if (part.rotation) trackball.setRotation(part.rotation);
  send(part);
}

/** Shows the session's state as the server has it, but never against the user's own hand. */
function adopt() {
  const isHeld = trackball.isDragging || orbit.isDragging || curves.isDragging;
  if (newest === null || isHeld || edits.isBusy) return;
  trackball.setRotation(newest.state.rotation);
  showView(newest.state.view.camera);
  materials.show(newest.state.material.parameter);
  curves.show(newest.state.material);
  controls.show(newest.state);
}

function isNewer(message) {
  return newest === null || message.epoch > newest.epoch ||
    (message.epoch === newest.epoch && message.revision > newest.revision);
}

const handlers = {
  welcome(message) {
    newest = message;
    edits.restart();
    viewer.setSize(message.size);
    sceneCamera = message.camera;
    orbit.setHome(message.camera, message.any_view);
    showView(message.state.view.camera);
    for (const id of ['drag', 'reset-view']) element(id).hidden = !message.any_view;
    if (!message.any_view) element('drag-light').checked = true;
    element('view-help').hidden = !message.any_view;
    materials.setMaterials(message.materials);
    curves.setScene(message.scene, message.editable, message.measured);
    controls.setEnvironments(message.environments);
    uploads.setPlace(message.session, message.scene);
    element('scene').textContent = message.scene;
    element('session').textContent = message.session === 'default' ? '' : message.session;
    document.title = `${message.scene} – Rimlight`;
    adopt();
  },
  environments(message) {
    controls.setEnvironments(message.environments);
    adopt();
  },
  ack(message) {
    edits.acknowledged(message.id, message.revision);
    handlers.state(message);
  },
  state(message) {
    if (isNewer(message)) newest = message;
    adopt();
  },
  error(message) {
    if (message.id) edits.refused(message.id);
    toasts.say(message.reason);
  },
};

connection.addEventListener('message', ({ detail }) => {
  handlers[detail.type]?.(detail);
  showBusy();
});

connection.addEventListener('frame', async ({ detail }) => {
  try {
    await viewer.draw(detail);
  } catch (failure) {
    toasts.say(`A frame could not be shown: ${failure.message}`);
  }
  const now = performance.now();
  connection.send({ type: 'frame_ack', frame: detail.header.frame });
  measurements.show(detail.header, detail.bytes,
    edits.latencyOf(detail.header.revision, now), now);
  shown = detail.header;
  element('canvas').dataset.frame = shown.frame;
  element('canvas').dataset.exact = shown.exact;
  showBusy();
});

connection.addEventListener('status', ({ detail }) => {
  const words = {
    open: 'Connected',
    connecting: detail.again ? 'Reconnecting…' : 'Connecting…',
    waiting: `Connection lost. Reconnecting in ${Math.max(1, Math.round(detail.seconds))} s…`,
  };
  const status = element('connection');
  status.textContent = words[detail.state];
  status.dataset.state = detail.state;
  element('picture').classList.toggle('stale', detail.state !== 'open');
});

connection.open();
