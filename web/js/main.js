import { authorization, takeToken } from './access.js';
import { Connection } from './connection.js';
import { Controls } from './controls.js';
import { CurveEditor } from './curve_editor.js';
import { Display } from './display.js';
import { Edits } from './edits.js';
import { FrameDecoder } from './frame_decoder.js';
import { Gestures } from './gestures.js';
import { EnvironmentUpload, reasonOf } from './environment_upload.js';
import { Materials } from './materials.js';
import { Measurements } from './measurements.js';
import { Orbit } from './orbit.js';
import { Resume } from './resume.js';
import { SessionTools } from './session_tools.js';
import { Toasts } from './toasts.js';
import { Trackball } from './trackball.js';
import { Viewer } from './viewer.js';

const element = (id) => document.getElementById(id);

const token = takeToken(window);

const parameters = new URLSearchParams(window.location.search);
const session = parameters.get('session') || 'default';
const scene = parameters.get('scene') ?? '';
const sessionPath = `/sessions/${encodeURIComponent(session)}`;
const resume = new Resume(window.sessionStorage, session, scene);

/** ws://HOST/sessions/NAME/stream?scene=NAME, from this page's own ?session=…&scene=…. */
function streamUrl() {
  const protocol = window.location.protocol === 'https:' ? 'wss:' : 'ws:';
  const query = new URLSearchParams({ ...resume.query, parts: 1 });
  if (scene) query.set('scene', scene);
  if (token) query.set('token', token); // a browser's WebSocket has no headers to set
  return `${protocol}//${window.location.host}${sessionPath}/stream?${query}`;
}

/** The session's state as a file. */
async function download() {
  const query = scene ? `?${new URLSearchParams({ scene })}` : '';
  const response = await fetch(`${sessionPath}/state${query}`, { headers: authorization(token) });
  if (!response.ok) throw new Error(`${response.status}`);
  return { name: `${session}.json`, text: await response.text() };
}

/** A state that is too large for a message, as a step of this user. */
async function upload(text) {
  const query = new URLSearchParams(resume.query.resume ? { resume: resume.query.resume } : {});
  if (scene) query.set('scene', scene);
  const response = await fetch(`${sessionPath}/state?${query}`, { method: 'PUT', headers: authorization(token), body: text });
  if (!response.ok) throw new Error(`The state was not taken: ${reasonOf(await response.text())}`);
}

const connection = new Connection(streamUrl);
const gestures = new Gestures(document);
const edits = new Edits((message) => connection.send(message), () => gestures.current);
const viewer = new Viewer(element('canvas'), element('stage'));
const decoder = new FrameDecoder();
const display = new Display((message) => connection.send(message));
const measurements = new Measurements(document);
const toasts = new Toasts(element('toasts'));
const tools = new SessionTools({
  onCommand: (message) => {
    edits.command(message);
    showBusy();
  },
  onError: (text) => toasts.say(text),
  download,
  upload,
});
const controls = new Controls(change);
const materials = new Materials(change);
const uploads = new EnvironmentUpload({
  headers: authorization(token),
  onReady: (name) => change({ environment: name }),
  onLeave: (name) => change({ environment: name }),
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
  if (!tools.canEdit) return;
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
    decoder.reset();
    display.tell();
    edits.restart();
    resume.keep(message.resume, message.revision);
    tools.welcome(message);
    if (message.missed > 0) toasts.say(`${message.missed} changes while you were away.`);
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
    uploads.setShown(message.state.environment, tools.canEdit);
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
    tools.history(message.history);
    handlers.state(message);
  },
  state(message) {
    if (isNewer(message)) {
      newest = message;
      uploads.setShown(message.state.environment, tools.canEdit);
      tools.changed(message.by);
    }
    adopt();
  },
  deleted(message) {
    connection.end(`This session was deleted${message.by ? ` by ${message.by.name}` : ''}.`);
    toasts.say('This session was deleted.');
  },
  presence: (message) => tools.presence(message),
  snapshots: (message) => tools.snapshots(message),
  error(message) {
    const type = message.id && edits.refused(message.id);
    const isTravel = type === 'undo' || type === 'redo';
    toasts.say(isTravel ? `Nothing to ${type}: others have changed it since.` : message.reason);
    adopt();
  },
};

connection.addEventListener('message', ({ detail }) => {
  handlers[detail.type]?.(detail);
  showBusy();
});

/** Draws a frame; false when it is one part of an image that has not come whole. */
async function show(frame) {
  try {
    const picture = await decoder.decode(frame);
    if (picture === null) return false;
    viewer.draw(picture, frame.header);
    picture.close();
  } catch (failure) {
    if (frame.header.codec === 'vp8') display.giveUpVp8();
    else toasts.say(`A frame could not be shown: ${failure.message}`);
  }
  return true;
}

connection.addEventListener('frame', async ({ detail }) => {
  const isShown = await show(detail);
  const now = performance.now();
  connection.send({ type: 'frame_ack', frame: detail.header.frame });
  if (!isShown) return;
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
    ended: detail.text,
    waiting: `Connection lost. Reconnecting in ${Math.max(1, Math.round(detail.seconds))} s…`,
  };
  const status = element('connection');
  status.textContent = words[detail.state];
  status.dataset.state = detail.state;
  element('picture').classList.toggle('stale', detail.state !== 'open');
});

addEventListener('pagehide', () => {
  if (newest) resume.keep(resume.query.resume, newest.revision);
});

connection.open();
